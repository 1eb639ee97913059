"""The lines that are to be done, and what became of them: as a table to read, and as a file."""

from __future__ import annotations

import csv
import os
import socket
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import click

from ..errors import UserError, counted
from ..files import written_atomically
from ..motion import tally
from ..workers import run_all
from .journal import Journal, made_from
from .listing import Job

OK, FAILED, SKIPPED = "ok", "failed", "skipped"
MOST_ROWS = 30  # of a table that is printed whole; of a longer one, what failed


@dataclass(frozen=True)
class Result:
    """What became of a line; `error` says in one line why it failed, and is empty otherwise."""

    job: Job
    status: str
    seconds: float
    frames: int
    attempts: int
    error: str
    log: Path

    @property
    def rate(self) -> float:
        """Frames a second."""
        return self.frames / self.seconds if self.seconds > 0.0 else 0.0


def run_lines(
    jobs: Sequence[Job],
    journal: Journal,
    logs: Path,
    *,
    processes: int,
    scheduler: str | None,
    resume: bool,
) -> Iterator[Result]:
    """Do the lines, and yield what became of each as it ends; with `resume` not those done.

    logs: the folder of what the lines print, one file each.
    """
    waiting: list[Job] = []
    for job in jobs:
        made = journal.made(job) if resume else None
        if made is None:
            waiting.append(job)
            continue
        yield Result(job, SKIPPED, made["seconds"], made["frames"], 0, "", _log(logs, job))
    journal.begin(waiting)
    states = [made_from(job) for job in waiting]
    files = [_log(logs, job) for job in waiting]
    for file in files:
        file.unlink(missing_ok=True)
    for outcome in run_all(do, waiting, jobs=processes, scheduler=scheduler, logs=files):
        job, frames = waiting[outcome.index], outcome.result or 0
        if outcome.error is None:
            journal.add(job, states[outcome.index], frames, outcome.seconds)
        status, log = OK if outcome.error is None else FAILED, files[outcome.index]
        error = outcome.error or ""
        yield Result(job, status, outcome.seconds, frames, outcome.attempts, error, log)


def _log(folder: Path, job: Job) -> Path:
    return folder / f"line_{job.number:04d}.log"


def do(job: Job) -> int:
    """In a process that works: do a line, and return how many frames were played for it."""
    print(f"risorius {job.text}", flush=True)
    try:
        os.chdir(job.folder)
    except OSError as error:
        raise UserError(
            f"{job.folder}: {error.strerror} on {socket.gethostname()}; whoever works on a list "
            "needs the folders that it names"
        ) from None
    module, _, name = job.command.partition(":")
    command: click.Command = getattr(import_module(module), name)
    before = tally.frames
    try:
        command.main(list(job.arguments), prog_name=f"risorius {name}", standalone_mode=False)
    except click.ClickException as error:
        raise UserError(error.format_message()) from None
    sys.stdout.flush()
    return tally.frames - before


def table(results: Sequence[Result], seconds: float) -> Iterator[str]:
    """Rows of what became of the lines, and a last one for all, which took so many seconds."""
    yield f"{'line':>6}  {'':7}  {'seconds':>8}  {'frames/s':>8}"
    for each in sorted(results, key=lambda each: each.job.number):
        if len(results) > MOST_ROWS and each.status != FAILED:
            continue
        rate = f"{each.rate:8.1f}" if each.frames else " " * 8
        what = each.error or " ".join(map(str, each.job.outputs))
        yield f"{each.job.number:6}  {each.status:7}  {each.seconds:8.1f}  {rate}  {what}"
    counts = {name: sum(each.status == name for each in results) for name in (OK, FAILED, SKIPPED)}
    frames = sum(each.frames for each in results if each.status == OK)
    told = ", ".join(f"{number} {name}" for name, number in counts.items())
    rate = f", {frames / seconds:.1f} a second" if seconds > 0.0 else ""
    yield f"{counted(len(results), 'line')}: {told}; {counted(frames, 'frame')}{rate}"


def save_summary(target: Path, results: Sequence[Result]) -> None:
    """Write a CSV file with a row for each line; UserError where that cannot be."""
    rows = [
        {
            "line": each.job.number,
            "status": each.status,
            "seconds": f"{each.seconds:.3f}",
            "frames": each.frames,
            "frames_per_second": f"{each.rate:.3f}",
            "attempts": each.attempts,
            "outputs": " ".join(map(str, each.job.outputs)),
            "error": each.error,
            "log": each.log,
            "command": each.job.text,
        }
        for each in sorted(results, key=lambda each: each.job.number)
    ]
    with (
        written_atomically(target) as part,
        part.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
