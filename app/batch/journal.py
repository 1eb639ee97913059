"""What was made by which line, of what: a file to which a line is added for everything done.

A line of it that was cut off, because whoever wrote it was killed, counts for nothing: what it
told of is made once more.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from risorius import __version__

from ..files import NoSuchFileError, cannot_be_written, read_text
from ..process_cache import file_state
from .listing import LONGEST, Job


class Journal:
    """The journal in a file, which need not be there."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._made: dict[tuple[str, str], dict[str, Any]] = {}  # by line and folder
        self._begun: set[str] = set()  # outputs that were not there before
        try:
            text = read_text(path, what="journal", longest=LONGEST)
        except NoSuchFileError:
            return
        for line in text.splitlines():
            try:
                self._take(json.loads(line))
            except (ValueError, KeyError, TypeError, AttributeError):
                continue

    def _take(self, entry: dict[str, Any]) -> None:
        self._begun.update(entry.get("begun", ()))
        if "line" in entry:
            self._made[entry["line"], entry["folder"]] = entry

    def made(self, job: Job) -> dict[str, Any] | None:
        """What is known of a line that was done, if it would give the same now; None otherwise."""
        entry = self._made.get((job.text, str(job.folder)))
        if entry is None or any(entry.get(key) != value for key, value in made_from(job).items()):
            return None
        return entry if entry["outputs"] and entry["outputs"] == _outputs(job) else None

    def began(self, output: Path) -> bool:
        """Whether what is in an output's place was put there by a batch, for all that is known."""
        return str(output) in self._begun

    def begin(self, jobs: Sequence[Job]) -> None:
        """These lines are done from here on; what they write is a batch's to write again."""
        self._add({"begun": [str(output) for job in jobs for output in job.outputs]})

    def add(self, job: Job, state: dict[str, Any], frames: int, seconds: float) -> None:
        """A line is done; `state` is what `made_from` gave before."""
        self._add({**state, "outputs": _outputs(job), "frames": frames, "seconds": seconds})

    def _add(self, entry: dict[str, Any]) -> None:
        self._take(entry)
        with cannot_be_written(self._path), self._path.open("a", encoding="utf-8") as file:
            file.write(f"\n{json.dumps(entry)}")  # the last line may have been cut off


def made_from(job: Job) -> dict[str, Any]:
    """All that decides what a line gives."""
    inputs = [list(file_state(path)) for path in job.inputs]
    return {
        "line": job.text,
        "folder": str(job.folder),
        "risorius": __version__,
        "inputs": inputs,
    }


def _outputs(job: Job) -> list[list[Any]] | None:
    """Places and sizes of what a line has written; None where any of it is missing."""
    found: list[list[Any]] = []
    for path in job.outputs:
        if path.is_dir():
            found.append([str(path), sum(1 for _ in path.iterdir())])
        elif path.is_file():
            found.append([str(path), path.stat().st_size])
        else:
            return None
    return found
