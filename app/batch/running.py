"""Run the lines of a list, and report the results as text and as a CSV file."""

from __future__ import annotations

import csv
import os
import socket
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import click

from ..errors import UserError
from ..files import written_atomically
from ..stopping import cleaned_up_if_stopped
from ..tally import tally
from ..text import as_text, counted
from ..workers import Send, WorkerPool
from .listing import Job

DONE_STATE = "ok"
FAILED_STATE = "failed"
SKIPPED_STATE = "skipped"


@dataclass(frozen=True)
class LineResult:
    """The result of a line; error: the reason of a failure as one line of text, or ""."""

    job: Job
    status: str
    seconds: float = 0.0
    frames: int = 0
    error: str = ""


def run_lines(
    jobs: Sequence[Job], *, processes: int, scheduler: str | None, resume: bool
) -> Iterator[LineResult]:
    """Run all lines, and yield the result of each when it ends; `resume` skips finished lines."""
    done = {job for job in jobs if resume and job.is_done()}
    waiting = [job for job in jobs if job not in done]
    yield from (LineResult(job, SKIPPED_STATE) for job in done)
    for job in waiting:
        job.log.unlink(missing_ok=True)
    if scheduler is None:
        yield from _run_here(waiting, processes)
        return
    from ..cluster import run_on_cluster

    for job, result, why in run_on_cluster(do_line, waiting, scheduler):
        yield result or LineResult(job, FAILED_STATE, error=why)


def _run_here(jobs: Sequence[Job], processes: int) -> Iterator[LineResult]:
    pool = WorkerPool(processes)
    with cleaned_up_if_stopped(pool.stop), ThreadPoolExecutor(processes) as threads:
        try:
            for ended in as_completed([threads.submit(do_line, pool, job) for job in jobs]):
                yield ended.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
            pool.stop()


def do_line(pool: WorkerPool, job: Job) -> LineResult:
    """Run a line in a process of the pool."""
    begin = time.monotonic()
    frames = list[int]()
    try:
        pool.run(_run_line, job, on_message=frames.append, log=job.log)
    except UserError as error:
        return LineResult(job, FAILED_STATE, time.monotonic() - begin, error=str(error))
    return LineResult(job, DONE_STATE, time.monotonic() - begin, frames[-1])


def _run_line(job: Job, send: Send) -> None:
    """Run a line in this process, and send the number of frames that it played."""
    print(f"risorius {job.text}", flush=True)
    try:
        os.chdir(job.folder)
    except OSError as error:
        raise UserError(
            f"{job.folder}: {error.strerror} on {socket.gethostname()}; each computer "
            "that works on a list needs the folders that the list names"
        ) from None
    module, _, name = job.command.partition(":")
    command: click.Command = getattr(import_module(module), name)
    try:
        command.main(list(job.arguments), prog_name=f"risorius {name}", standalone_mode=False)
    except click.ClickException as error:
        raise UserError(error.format_message()) from None
    send(tally.frames)


def in_words(results: Sequence[LineResult], seconds: float) -> str:
    """Summarize the results of all commands in one sentence. seconds: the batch's duration."""
    counts = {
        name: sum(each.status == name for each in results)
        for name in (DONE_STATE, FAILED_STATE, SKIPPED_STATE)
    }
    frames = sum(each.frames for each in results if each.status == DONE_STATE)
    outcomes = ", ".join(f"{number} {name}" for name, number in counts.items())
    rate = f", {frames / seconds:.1f} a second" if seconds > 0.0 else ""
    return f"{counted(len(results), 'line')}: {outcomes}; {counted(frames, 'frame')}{rate}"


def save_summary(target: Path, results: Sequence[LineResult]) -> None:
    """Write a CSV file with a row for each line; raises UserError if this fails."""
    rows = [
        {
            "line": each.job.number,
            "status": each.status,
            "seconds": f"{each.seconds:.3f}",
            "frames": each.frames,
            "outputs": as_text(" ".join(map(str, each.job.outputs))),
            "error": each.error,
            "log": as_text(each.job.log),
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
