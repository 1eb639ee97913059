"""The folder of a data set: samples whole or not at all, and how it was begun.

The files of a sample are written in `.unfinished` and renamed, its .json last, so that each is
whole under its final name, whenever the process is killed. What happened to them since is found by
digests: a sample counts as made when all of its files are as they were written.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from risorius.assets.staging import is_staging_folder, locked

from ..errors import UserError
from ..files import cannot_be_written, real_path, save_text

BEGUN = "dataset.json"  # how the set was begun
UNFINISHED = ".unfinished"
DIGEST = "digest"  # of all other labels; the last of them
_SAMPLE = re.compile(r"(\d{6})\.json")


def name_of(index: int) -> str:
    """What the files of a sample begin with."""
    return f"{index:06d}"


class SetFolder:
    """A folder that holds one data set."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def log(self) -> Path:
        """What processes print; it goes when the set is made."""
        return self.path / UNFINISHED / "log"

    @contextlib.contextmanager
    def held(self, options: Mapping[str, Any], *, resume: bool) -> Iterator[None]:
        """Begin a set in an empty folder, or resume one, and keep others out meanwhile.

        options: all that decides what samples are, as JSON has it. Raises UserError where the
        folder holds something else, or a set that was begun with other options.
        """
        if real_path(self.path).is_file():
            raise UserError(f"{self.path}: is a file; name a folder")
        with cannot_be_written(self.path):
            self.path.mkdir(parents=True, exist_ok=True)
            self._check(options, resume=resume)
            unfinished = self.path / UNFINISHED
            unfinished.mkdir(exist_ok=True)
            lock = locked(unfinished / "lock")
        if lock is None:
            raise UserError(f"{self.path}: another process is making this set; wait for its end")
        with lock:
            with cannot_be_written(self.path):
                for left in unfinished.glob("[0-9]*"):
                    shutil.rmtree(left)
            if not self.there():
                save_text(self.path / BEGUN, json.dumps(options, indent=1) + "\n")
            yield
        with cannot_be_written(self.path):
            shutil.rmtree(unfinished)

    def _check(self, options: Mapping[str, Any], *, resume: bool) -> None:
        """UserError unless this is an empty folder, or the set that is to be resumed.

        A set that ended before its first sample may be begun anew, in another way.
        """
        begun = self.path / BEGUN
        if not begun.exists():
            items = (item for item in self.path.iterdir() if not is_staging_folder(item))
            if any(item.name != UNFINISHED for item in items):
                raise UserError(f"{self.path}: is not empty and no data set; name another folder")
            return
        try:
            was = json.loads(begun.read_text("utf-8"))
            assert isinstance(was, dict) and "risorius" in was
        except (ValueError, AssertionError):
            raise UserError(
                f"{begun}: does not say how a set was begun; name another folder"
            ) from None
        if not self.there():
            return
        if not resume:
            raise UserError(f"{self.path}: holds a data set; add --resume, or name another folder")
        for name in dict.fromkeys((*was, *options)):
            if was.get(name) != options.get(name):
                raise UserError(
                    f"{self.path}: was begun with {name} {_short(was.get(name))}, not "
                    f"{_short(options.get(name))}; give the same to --resume, or name another "
                    "folder"
                )

    def there(self) -> set[int]:
        """The numbers of the samples of which there is a .json."""
        with os.scandir(self.path) as items:
            found = (_SAMPLE.fullmatch(item.name) for item in items)
            return {int(match[1]) for match in found if match}

    def has(self, index: int) -> bool:
        """Whether a sample is whole: all of its files are there as they were written."""
        try:
            labels = self.sample(index)
            told, files = labels.pop(DIGEST), labels["files"]
            return bool(
                labels["index"] == index
                and told == _digest_of(_text_of(labels).encode())
                and all(_digest_of(self._read(name)) == each for name, each in files.items())
            )
        except (OSError, ValueError, LookupError, TypeError, AttributeError):
            return False  # whatever stands in its place

    def _read(self, name: str) -> bytes:
        return (self.path / name).read_bytes()

    def write_sample(self, index: int, write: Callable[[Path], object]) -> int:
        """Put the files of a sample in place, .json last; how many bytes they have.

        write: writes a picture of the name that it is given, and what lies beside it.
        """
        name = name_of(index)
        with cannot_be_written(self.path / name):
            part = Path(tempfile.mkdtemp(prefix=name, dir=self.path / UNFINISHED))
            try:
                write(part / f"{name}.png")
                _seal(part / f"{name}.json")
                made = sorted(part.iterdir(), key=lambda path: (path.suffix == ".json", path))
                size = sum(path.stat().st_size for path in made)
                for path in made:
                    os.replace(path, self.path / path.name)
            finally:
                shutil.rmtree(part, ignore_errors=True)
        return size

    def sample(self, index: int) -> dict[str, Any]:
        """What is in the .json of a sample."""
        labels: dict[str, Any] = json.loads(self._read(f"{name_of(index)}.json"))
        return labels


def _seal(file: Path) -> None:
    """Add the digests of what lies beside the .json of a sample, and of its own content."""
    labels = json.loads(file.read_bytes())
    beside = sorted(path for path in file.parent.iterdir() if path != file)
    labels["files"] = {path.name: _digest_of(path.read_bytes()) for path in beside}
    labels[DIGEST] = _digest_of(_text_of(labels).encode())
    file.write_text(_text_of(labels), encoding="utf-8")


def _text_of(labels: Mapping[str, Any]) -> str:
    return json.dumps(labels, separators=(",", ":"), allow_nan=False)


def _digest_of(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) < 60 else f"{text[:57]}..."
