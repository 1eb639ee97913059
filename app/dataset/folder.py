"""The folder of a data set, which holds samples and the options of the set.

The files of a sample are written in `.unfinished`, and then moved to their final names, the .json
last. So a file with its final name is complete, even if the process is killed at any time. The
.json holds the lengths of the other files. A sample counts as made if all its files exist with
these lengths, which reveals a full disk, an interrupted copy, or a deleted file.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ..errors import UserError
from ..files import cannot_be_written, check_links, save_text
from ..staging import is_staging_folder, locked
from .shards import SHARD_PATTERN, read_shard

UNFINISHED_SUFFIX = ".unfinished"
TOKEN_PREFIX = "seen-"  # prefix of files by which workers recognise the set's folder
LENGTHS_LABEL = "files"  # label that holds the lengths of a sample's other files [bytes]


def name_of(index: int) -> str:
    """Return the digits with which the names of a sample's files begin."""
    return f"{index:06d}"


class SetFolder:
    """A folder that holds one data set."""

    BEGUN = "dataset.json"  # options of the set

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def log(self) -> Path:
        """The file that collects output of processes; it is removed when the set is complete."""
        return self.path / UNFINISHED_SUFFIX / "log"

    @contextlib.contextmanager
    def opened(self, options: Mapping[str, Any], *, resume: bool) -> Iterator[None]:
        """Begin a set in an empty folder, or resume a set; within this context, lock the folder.

        options: all options that determine the samples, as JSON values. Raises UserError if the
        folder holds something else, or a set that was begun with other options.
        """
        check_links(self.path)
        if self.path.is_file():
            raise UserError(f"{self.path}: is a file; choose a folder")
        with cannot_be_written(self.path):
            self.path.mkdir(parents=True, exist_ok=True)
            self._check(options, resume=resume)
            unfinished = self.path / UNFINISHED_SUFFIX
            if unfinished.is_symlink():  # the linked folder may hold foreign files
                raise UserError(f"{unfinished}: is a link; remove it")
            unfinished.mkdir(exist_ok=True)
            lock = locked(unfinished / "lock")
        if lock is None:
            raise UserError(f"{self.path}: another process is making this set; wait for its end")
        with lock:
            with cannot_be_written(self.path):
                for left in unfinished.glob("[0-9]*"):
                    shutil.rmtree(left)
                for left in unfinished.glob(f"{TOKEN_PREFIX}*"):
                    left.unlink()
                self.log.unlink(missing_ok=True)
            if not self._has_samples():
                save_text(self.path / self.BEGUN, json.dumps(options, indent=1) + "\n")
            yield
        with cannot_be_written(self.path):
            shutil.rmtree(unfinished)

    def _check(self, options: Mapping[str, Any], *, resume: bool) -> None:
        """Raise UserError unless the folder is empty, or holds the set that is to be resumed.

        A set without samples may begin again with other options.
        """
        begun = self.path / self.BEGUN
        if not begun.exists():
            items = (item for item in self.path.iterdir() if not is_staging_folder(item))
            if any(item.name != UNFINISHED_SUFFIX for item in items):
                raise UserError(
                    f"{self.path}: is not empty, and no data set; choose another folder"
                )
            return
        try:
            was = json.loads(begun.read_text("utf-8"))
            assert isinstance(was, dict) and "risorius" in was
        except (ValueError, AssertionError):
            raise UserError(
                f"{begun}: does not hold the options of a data set; choose another folder"
            ) from None
        if not self._has_samples():
            return
        if not resume:
            raise UserError(
                f"{self.path}: holds a data set; add --resume, or choose another folder"
            )
        for name in dict.fromkeys((*was, *options)):
            if was.get(name) != options.get(name):
                raise UserError(
                    f"{self.path}: was begun with {name} {_short_text(was.get(name))}, not "
                    f"{_short_text(options.get(name))}; repeat the old value, or choose another "
                    "folder"
                )

    def numbers(self) -> set[int]:
        """Return the numbers of all samples with a .json, in the folder or in a shard."""
        shards = map(read_shard, self.path.glob(SHARD_PATTERN))
        packed = {number for shard in shards if shard for number in shard.places}
        with os.scandir(self.path) as items:
            sample_name = re.compile(r"(\d{6})\.json")
            found = (sample_name.fullmatch(item.name) for item in items)
            return packed | {int(match[1]) for match in found if match}

    def _has_samples(self) -> bool:
        """Whether the folder has a sample or a shard."""
        return bool(self.numbers()) or any(self.path.glob(SHARD_PATTERN))

    def has(self, index: int) -> bool:
        """Whether all files of a sample exist and are complete, by the lengths in its .json."""
        try:
            labels = self.sample(index)
        except (OSError, ValueError, RecursionError):  # missing, torn, or another file
            return False
        if not isinstance(labels, dict) or labels.get("index") != index:
            return False
        lengths = labels.get(LENGTHS_LABEL)
        if not isinstance(lengths, dict) or f"{name_of(index)}.png" not in lengths:
            return False
        return all(_file_length(self.path / name) == length for name, length in lengths.items())

    def write_sample(self, index: int, write: Callable[[Path], object]) -> int:
        """Write the files of a sample, the .json last; return their size [bytes].

        write: function that writes the picture to a path, and all other files beside it.
        """
        name = name_of(index)
        with cannot_be_written(self.path / name):
            part = Path(tempfile.mkdtemp(prefix=name, dir=self.path / UNFINISHED_SUFFIX))
            try:
                write(part / f"{name}.png")
                _add_lengths(part / f"{name}.json")
                made = sorted(part.iterdir(), key=lambda path: (path.suffix == ".json", path))
                size = sum(path.stat().st_size for path in made)
                for path in made:
                    os.replace(path, self.path / path.name)
            finally:
                shutil.rmtree(part, ignore_errors=True)
        return size

    def take_sample(self, index: int, files: Mapping[str, bytes]) -> int:
        """Write the files of a sample that another computer made; return their size [bytes]."""

        def write(picture: Path) -> None:
            for name, content in files.items():
                (picture.parent / name).write_bytes(content)

        return self.write_sample(index, write)

    def files_of(self, index: int) -> list[Path]:
        """Return the files of a sample, its .json first."""
        names = [f"{name_of(index)}.json", *sorted(self.sample(index)[LENGTHS_LABEL])]
        return [self.path / name for name in names]

    def sample(self, index: int) -> dict[str, Any]:
        """Return the labels in the .json of a sample."""
        content = (self.path / f"{name_of(index)}.json").read_bytes()
        labels: dict[str, Any] = json.loads(content)
        return labels


def _add_lengths(file: Path) -> None:
    """Add the lengths of the files beside a sample's .json to its labels."""
    labels = json.loads(file.read_bytes())
    beside = sorted(path for path in file.parent.iterdir() if path != file)
    labels[LENGTHS_LABEL] = {path.name: path.stat().st_size for path in beside}
    file.write_text(json.dumps(labels, separators=(",", ":")) + "\n", encoding="utf-8")


def _file_length(file: Path) -> int | None:
    """Return the length of a plain file [bytes], or None if there is no such file."""
    try:
        return file.stat().st_size if file.is_file() else None
    except (OSError, ValueError):  # an impossible name is a ValueError
        return None


def _short_text(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) < 60 else f"{text[:57]}..."
