"""A list of commands, one on each line, and the conflicts between its lines."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError
from ..files import entry_of, read_text


@dataclass(frozen=True)
class Job:
    """A line of the list, which is a command to run.

    command: its click command, "module:name". folder: the folder in which its paths begin.
    inputs, outputs: the files that it reads and writes. log: the file for its output.
    """

    number: int
    text: str
    command: str
    arguments: tuple[str, ...]
    folder: Path
    inputs: tuple[Path, ...]
    outputs: tuple[Path, ...]
    log: Path

    def is_done(self) -> bool:
        """Whether all outputs exist, and none of them is older than an input.

        An output that exists is complete, because commands write their files atomically.
        """
        files = (*self.outputs, *self.inputs)
        if not all(path.exists() for path in files):
            return False
        times = [path.stat().st_mtime_ns for path in files]
        count = len(self.outputs)
        return min(times[:count]) >= max(times[count:], default=0)


def lines_of(path: Path) -> Iterator[tuple[int, str]]:
    """Yield number and text of each line with a command.

    Raises UserError for an unreadable file.
    """
    text = read_text(path, what="list", longest=64 << 20)  # 64 MiB
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if stripped and not stripped.startswith("#"):
            yield number, stripped


def words_of(text: str) -> list[str]:
    """Split a line into words as a shell does.

    Raises UserError for a quotation mark without its partner, and for NUL.
    """
    if "\0" in text:
        raise UserError("holds a NUL character, which no name of a file can have")
    try:
        return shlex.split(text)
    except ValueError as error:
        raise UserError(f"a quotation mark without its partner ({error})") from None


def clashes(jobs: Sequence[Job]) -> Iterator[tuple[int, str]]:
    """Yield number and reason for each line whose files conflict with another line."""
    writer_of: dict[str, Job] = {}
    for job in jobs:
        for output in job.outputs:
            other = writer_of.setdefault(entry_of(output), job)
            if other is not job:
                yield job.number, f"{output}: is written by line {other.number} already"
    for job in jobs:
        for file in job.inputs:
            names = (entry_of(file), os.path.realpath(file))
            others = [writer_of[name] for name in names if writer_of.get(name, job) is not job]
            if others:
                yield (
                    job.number,
                    f"{file}: is written by line {others[0].number}, and lines have no "
                    "order; make two lists",
                )
