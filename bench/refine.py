"""How long a frame of refinement takes, for every built-in refiner on the same mesh and motion.

Kähler, Haber, Seidel 2003, Table 1 compares the static with the refined mesh. Here the time of the
refiner alone is taken, from positions to a filled stream, everything counted: normals, criterion,
points, table, output and the call from Python.

The methods are run interleaved, forwards and backwards in turn, with garbage collection off, and
medians are reported: on a shared machine times drift by a third within a run, and so only rows of
one run can be compared. The best time is reported beside the median for the same reason.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import refine

from .timing import interleaved

METHODS: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("none", {}),
    ("kahler", {}),
    ("loop", {"levels": 1}),
    ("loop", {"levels": 2}),
)
"""Refiners and their options, in the order of the rows."""


@dataclass(frozen=True)
class Row:
    """One refiner on one mesh."""

    refiner: str
    """Name of the refiner."""
    options: Mapping[str, Any]
    """Its options."""
    triangles_in: int
    """Triangles of the mesh."""
    triangles_out: float
    """Triangles of the output, mean over the frames."""
    triangles_most: int
    """Triangles of the output, largest of all frames."""
    milliseconds: float
    """Time of a frame, median over the rounds [ms]."""
    best_milliseconds: float
    """Time of a frame, shortest of all rounds [ms]."""

    @property
    def nanoseconds_per_triangle(self) -> float:
        """Median time per output triangle [ns]."""
        return 1e6 * self.milliseconds / max(self.triangles_out, 1.0)


def run(
    faces: npt.NDArray[np.integer],
    rest_positions: npt.NDArray[np.floating],
    frames: Sequence[npt.NDArray[np.floating]],
    *,
    uv: npt.NDArray[np.floating] | None = None,
    face_uv: npt.NDArray[np.integer] | None = None,
    methods: Sequence[tuple[str, Mapping[str, Any]]] = METHODS,
    rounds: int = 200,
) -> list[Row]:
    """Time each method over all `frames`, `rounds` times, and return one row for each.

    `faces`: shape (F, 3); `rest_positions` and every frame: shape (V, 3); `uv`, `face_uv`: as for
    `refine.create`. Raises ValueError without frames or rounds, and what binding raises.
    """
    if not frames or rounds < 1:
        raise ValueError(
            f"at least one frame and one round are needed, got {len(frames)} and {rounds}"
        )
    refiners = [
        refine.create(name, faces, rest_positions, uv, face_uv, **options)
        for name, options in methods
    ]
    # The first pass compiles or loads the kernels, and counts.
    counts = [[len(refiner.refine(frame).triangles) for frame in frames] for refiner in refiners]
    calls = [_all_frames(refiner, frames) for refiner in refiners]
    seconds = interleaved(calls, rounds) / len(frames)
    return [
        Row(
            refiner=name,
            options=options,
            triangles_in=len(faces),
            triangles_out=float(np.mean(count)),
            triangles_most=max(count),
            milliseconds=1e3 * float(np.median(times)),
            best_milliseconds=1e3 * float(np.min(times)),
        )
        for (name, options), count, times in zip(methods, counts, seconds.T, strict=True)
    ]


def _all_frames(
    refiner: refine.Refiner, frames: Sequence[npt.NDArray[np.floating]]
) -> Callable[[], None]:
    """A call that refines every frame once."""

    def refine_all() -> None:
        for frame in frames:
            refiner.refine(frame)

    return refine_all
