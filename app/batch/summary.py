"""What became of the lines, as a table to read and as a file."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..errors import counted
from ..files import cannot_be_written, written_atomically
from .running import FAILED, OK, SKIPPED, Result

MOST_ROWS = 30  # of a table that is printed whole; of a longer one, what failed
COLUMNS = (
    "line", "status", "seconds", "frames", "frames_per_second", "attempts", "outputs", "error",
    "log", "command",
)  # fmt: skip


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
    with (
        written_atomically(target) as part,
        cannot_be_written(target),
        part.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for each in sorted(results, key=lambda each: each.job.number):
            writer.writerow(
                (
                    each.job.number,
                    each.status,
                    f"{each.seconds:.3f}",
                    each.frames,
                    f"{each.rate:.3f}",
                    each.attempts,
                    " ".join(map(str, each.job.outputs)),
                    each.error,
                    each.log,
                    each.job.text,
                )
            )
