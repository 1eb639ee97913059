"""Read and write shards of a data set: tar files of WebDataset with many samples, and listings.

Shards exist because a million small files slow a file system down. If a shard has 1000 samples,
`shard-000003.tar` holds the samples 3000 to 3999. WebDataset divides the name of a file at its
first dot, so `003000_seg.png` is named `003000.seg.png` in a shard. The listing
`shard-000003.json`, which is written last, has the length of the tar file, and the position of each
sample in it.

WebDataset: Aizman, Maltby, Breuel 2019, "High Performance I/O For Large Scale Deep Learning",
IEEE Big Data.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
import tarfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from ..files import written_atomically

SHARD_PATTERN = "shard-[0-9][0-9][0-9][0-9][0-9][0-9].tar"


@dataclass(frozen=True)
class Shard:
    """A tar file of samples.

    places: sample number -> first byte in the file, and length [bytes].
    """

    path: Path
    places: Mapping[int, tuple[int, int]]

    def labels_of(self, number: int) -> dict[str, Any]:
        """Return the labels of a sample; its .json is the first of its files."""
        with self.path.open("rb") as file:
            file.seek(self.places[number][0])
            labels: dict[str, Any] = json.loads(next(_files_in(file))[1])
        return labels

    def place_of(self, number: int) -> dict[str, str | int]:
        """Return the position of a sample, for the index of the set."""
        first, length = self.places[number]
        return {"shard": self.path.name, "offset": first, "bytes": length}


def files_in(path: Path) -> Iterator[tuple[str, bytes]]:
    """Yield each readable file in a tar file: its name as an unpacked file, and its content."""
    with contextlib.suppress(OSError, tarfile.TarError), path.open("rb") as file:
        yield from _files_in(file)


def write_shard(path: Path, samples: Iterable[tuple[int, Sequence[Path]]]) -> Shard:
    """Write a shard; samples: number and files of each. Raises UserError if writing fails."""
    places: dict[int, tuple[int, int]] = {}
    with written_atomically(path) as part, part.open("wb") as file:
        with tarfile.open(fileobj=file, mode="w", format=tarfile.USTAR_FORMAT) as tar:
            first = 0
            for number, files in samples:
                length = sum(_add(tar, each) for each in files)
                places[number] = first, length
                first += length
    content = {"bytes": path.stat().st_size, "samples": places}
    with written_atomically(listing_of(path)) as part:
        part.write_text(json.dumps(content) + "\n", encoding="utf-8")
    return Shard(path, places)


def read_shard(path: Path) -> Shard | None:
    """Return the shard of a tar file; None if its length differs from that in its listing."""
    try:
        content = json.loads(listing_of(path).read_bytes())
        if content["bytes"] != path.stat().st_size:
            return None
        samples = content["samples"].items()
        return Shard(path, {int(number): (int(at), int(long)) for number, (at, long) in samples})
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def remove_shard(path: Path) -> None:
    """Delete a tar file and its listing, if they exist."""
    listing_of(path).unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def listing_of(path: Path) -> Path:
    """Return the path of a tar file's listing."""
    return path.with_suffix(".json")


def _add(tar: tarfile.TarFile, path: Path) -> int:
    """Add a file without time and owner, so that bytes are reproducible; return its size there."""
    content = path.read_bytes()
    member = tarfile.TarInfo(path.name.replace("_", ".", 1))
    member.size = len(content)
    tar.addfile(member, io.BytesIO(content))
    block = tarfile.BLOCKSIZE
    return block + -(-len(content) // block) * block


def _files_in(file: IO[bytes]) -> Iterator[tuple[str, bytes]]:
    """Yield name and content of the sample files in an open tar file, from its position on."""
    with tarfile.open(fileobj=file, mode="r:") as tar:
        for member in tar:
            content = tar.extractfile(member)
            name = re.fullmatch(r"(\d{6})\.(\w+(?:\.\w+)?)", member.name)
            if name and content is not None:
                mark = "_" if "." in name[2] else "."
                yield f"{name[1]}{mark}{name[2]}", content.read()
