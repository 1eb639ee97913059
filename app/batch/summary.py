"""What became of the lines, as a table to read and as a file."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

from ..errors import counted
from ..files import cannot_be_written, written_atomically
from .running import FAILED, OK, SKIPPED, Result

MOST_ROWS = 30  # of a table that is printed whole; of a longer one, what failed


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
        cannot_be_written(target),
        part.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
