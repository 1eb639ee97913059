"""What `risorius bench` prints: measurements of bench/ as tables."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from pathlib import Path

import bench.motion
import bench.simulate


def simulate_table(rounds: int, sizes: Sequence[int] = bench.simulate.SIZES) -> str:
    """Time a 60 Hz frame of the simulation on meshes of several sizes; the text to print."""
    lines = [
        f"One frame of 1/60 s, serial, one core of {processor()}: medians of {rounds}",
        "interleaved rounds; set up is not counted.",
        "",
        f"{'motion':28} {'vertices':>8} {'triangles':>9} {'ms':>8} {'best':>8} {'ns/vertex':>9}",
    ]
    for row in bench.simulate.run(rounds=rounds, sizes=sizes):
        lines.append(
            f"{row.motion:28} {row.vertices:8d} {row.triangles:9d} {row.milliseconds:8.3f} "
            f"{row.best_milliseconds:8.3f} {row.nanoseconds_per_vertex:9.0f}"
        )
    return "\n".join(lines)


def motion_table(reference: Path) -> str:
    """Score simulated against scanned skin motion; the text to print."""
    lines = [
        "Simulated against scanned displacement, area weighted: cosine 1 and magnitude 1 are equal",
        "fields, residual is the squared difference over the squared scan, peak is simulated.",
        "",
        f"{'expression':18} {'cosine':>7} {'magnitude':>9} {'residual':>8} {'peak':>7}",
    ]
    for row in bench.motion.run(reference):
        lines.append(
            f"{row.expression:18} {row.cosine:7.3f} {row.magnitude:9.2f} {row.residual:8.3f} "
            f"{row.peak:7.2f}"
        )
    return "\n".join(lines)


def processor() -> str:
    """The name of this machine's processor."""
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
