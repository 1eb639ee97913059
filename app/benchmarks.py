"""What `risorius bench` prints: measurements of bench/ as tables."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

import bench.motion
import bench.refine
import bench.simulate

from .scenes import Scene

Frames = list[npt.NDArray[np.float64]]
FACE_SECONDS = 1.5  # after this the face has settled in its expression
FULL_EXPRESSIONS = ("joy", "sadness", "surprise", "anger", "disgust", "fear")


def refine_table(rounds: int, scenes: Sequence[Scene]) -> str:
    """Time every refiner on each scene in full motion; the text to print."""
    lines = [
        f"Refinement, serial, one core of {processor()}: medians of {rounds} interleaved rounds;",
        "positions in, filled render buffers out (normals, criterion, points, table, output).",
        "",
        f"{'mesh':6} {'refiner':14} {'in':>6} {'out':>7} {'most':>6} {'ms':>8} {'best':>8} "
        f"{'ns/tri':>7}",
    ]
    for scene in scenes:
        frames = face_frames(scene) if scene.expressions else plane_frames(scene)
        methods = [
            (name, {**options, **scene.refiner_options.get(name, {})})
            for name, options in bench.refine.METHODS
        ]
        for row in bench.refine.run(
            scene.faces, scene.rest_positions, frames, methods=methods, rounds=rounds
        ):
            levels = f" {row.options['levels']}x" if "levels" in row.options else ""
            lines.append(
                f"{scene.name:6} {row.refiner + levels:14} {row.triangles_in:6d} "
                f"{row.triangles_out:7.0f} {row.triangles_most:6d} {row.milliseconds:8.4f} "
                f"{row.best_milliseconds:8.4f} {row.nanoseconds_per_triangle:7.1f}"
            )
    return "\n".join(lines)


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


def face_frames(scene: Scene) -> Frames:
    """The face at rest in each of the six basic expressions, at full strength."""
    frames = []
    for name in FULL_EXPRESSIONS:
        scene.reset()
        scene.pose({name: 1.0})
        scene.step(FACE_SECONDS)
        frames.append(scene.positions.copy())
    return frames


def plane_frames(scene: Scene) -> Frames:
    """The plane at eight moments of its wave."""
    frames = []
    for phase in np.arange(8) / 8.0:
        scene.pose({"amplitude": 1.0, "phase": float(phase)})
        scene.step(1.0 / 30.0)
        frames.append(scene.positions.copy())
    return frames


def processor() -> str:
    """The name of this machine's processor."""
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
