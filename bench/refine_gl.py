"""What a frame of refinement costs on the graphics card, by its own clock, beside the processor.

The meshes of `bench refine`, by the paper's rule and as the window shows them (cubic edges,
blended, normals of the refined surface). Milliseconds of the card are timer queries around a frame:
the upload of positions and all passes. Whoever draws by arrays uploads rows and triangles instead,
which is not in the milliseconds of the processor.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.app.errors import UserError
from risorius.refine_gl import KahlerGl
from risorius.refine_gl.context import own_context
from risorius.refine_gl.refined import GpuBuffers
from risorius.refine_gl.tables import GROUP
from risorius.render.surface import is_software

from .refine import Load, interleaved, load_of
from .report import processor, table

METHODS: Mapping[str, Mapping[str, Any]] = {
    "paper's rule": {},
    "window's look": {"scheme": "cubic", "criterion": "displacement+rest"},
}
STANDING = 1e-3  # [ms] no card does a frame within; software's clock stands still
FEWEST_ROUNDS, MOST_ROUNDS = 3, 100


@dataclass(frozen=True)
class Row:
    """One method on one mesh; numbers of triangles and bytes are means over its frames."""

    mesh: str
    method: str
    triangles_in: int
    triangles_out: float
    processor_milliseconds: float
    """Of a frame by `kahler`, from positions to filled arrays, median [ms]."""
    card_milliseconds: float
    """Of a frame's upload and passes, median [ms]."""
    dispatches: int
    upload_bytes: int
    """What a frame hands over,"""
    arrays_bytes: float
    """and what it would hand over as rows and triangles."""
    traffic_bytes: float
    """What the passes read and write at the least."""
    room_bytes: int
    """Of all buffers."""


@dataclass(frozen=True)
class Report:
    """All that one run found."""

    processor: str
    card: str
    """What OpenGL calls itself."""
    is_software: bool
    rows: list[Row] = field(default_factory=list)


def measure(
    sizes: Sequence[str],
    seconds: float,
    progress: Callable[[str], object] = lambda _: None,
) -> Report:
    """Measure each of `sizes` (see `refine.load_of`) for about `seconds`.

    Raises UserError without OpenGL 4.3.
    """
    found: list[Row] = []
    for size in sizes:
        progress(size)
        load = load_of(size)
        for method, options in METHODS.items():
            bound = refine.create("kahler-gl", load.faces, load.rest, **options)
            if not isinstance(bound, KahlerGl):
                raise UserError(
                    "--refiner kahler-gl: needs OpenGL 4.3; `risorius doctor` tells more"
                )
            found.append(_row(load, method, options, bound, seconds / len(METHODS)))
    own = own_context()
    driver = str(own.run(own.gl.info.__getitem__, "GL_RENDERER"))
    return Report(processor(), driver, is_software(driver), found)


def _row(
    load: Load, method: str, options: Mapping[str, Any], card: KahlerGl, seconds: float
) -> Row:
    """Time a method on all frames of a mesh."""
    serial = refine.create("kahler", load.faces, load.rest, **options)
    counts = [serial.refine(frame) for frame in load.frames]
    sizes = [(mesh.vertex_count, mesh.triangle_count) for mesh in counts]
    moved = [sum(traffic(card, frame).values()) for frame in load.frames]  # compiles
    times: list[float] = []
    own = own_context()
    room = card.vertex_columns, card.vertex_capacity, card.triangle_capacity
    buffers = own.run(GpuBuffers, own.gl, *room)

    def on_card() -> None:
        times.extend(own.run(_timed, own.gl, card, frame, buffers) for frame in load.frames)

    def on_processor() -> None:
        for frame in load.frames:
            serial.refine(frame)

    both = on_processor, on_card
    spent = interleaved(both, 1).sum()
    rounds = int(np.clip(seconds / max(spent, 1e-9), FEWEST_ROUNDS, MOST_ROUNDS))
    seconds_of = interleaved(both, rounds)[:, 0] / len(load.frames)
    arrays = [4 * card.vertex_columns * rows + 12 * triangles for rows, triangles in sizes]
    return Row(
        mesh=load.name,
        method=method,
        triangles_in=len(load.faces),
        triangles_out=float(np.mean([triangles for _, triangles in sizes])),
        processor_milliseconds=1e3 * float(np.median(seconds_of)),
        card_milliseconds=float(np.median(times)),
        dispatches=len(card.passes),
        upload_bytes=load.rest.nbytes,
        arrays_bytes=float(np.mean(arrays)),
        traffic_bytes=float(np.mean(moved)),
        room_bytes=card.room_bytes,
    )


def _timed(
    gl: moderngl.Context, card: KahlerGl, positions: npt.NDArray[np.float64], out: GpuBuffers
) -> float:
    """What a frame takes on the card, its upload too, by the card's own clock [ms]."""
    clock: Any = gl.query(time=True)
    gl.finish()
    start = time.perf_counter()
    with clock:
        card.refine(positions, out=out)
    gl.finish()
    waited = 1e3 * (time.perf_counter() - start)
    taken = 1e-6 * float(clock.elapsed)
    return taken if taken > STANDING else waited


def traffic(card: KahlerGl, positions: npt.NDArray[np.float64]) -> dict[str, int]:
    """Bytes that each pass of a frame reads and writes, where a thread keeps what it has read.

    Counted by what its threads name in shaders/: vectors of 16 bytes, numbers of 4.
    """
    mesh, frame = card.connectivity, card.refine(positions)
    v, e, f = mesh.vertex_count, len(mesh.edges), len(mesh.faces)
    w, r, m = len(mesh.wedge_vertices), len(mesh.attribute_edges), frame.triangle_count
    splits = card.splits[mesh.attribute_edges]
    once, twice = int((splits > 0).sum()), int((splits > 1).sum())
    values = 4 * (card.vertex_columns - 6)
    look_up = f * (3 * 8 + 12 + 3 * 12) + m * 20
    blocks = 8 * (r + 2 * f) // GROUP + 28
    if "quarters" in card.passes:
        moved = len(np.unique(mesh.edges[card.splits > 0]))
        return {
            "normals": v * (8 + 24 + 32) + 3 * f * (4 + 12 + 72),
            "mark": r * (4 + 8 + 32 + 4 + 8) + once * 8,
            "configure": f * (12 + 12 + 4 + 8),
            "offsets": blocks,
            "place": w * (8 + 32 + 24 + 2 * values)
            + moved * (8 * 20 + 16)
            + r * 4
            + once * (4 + 16 + 8 + 64 + 32 + 40 + 3 * values)
            + look_up,
            "quarters": r * 4 + twice * (28 + 16 + 48 + 12 + 5 * 16 + 60 + 6 * values),
        }
    centres = frame.vertex_count - w - int((splits + (splits >> 1)).sum())
    return {
        "normals": v * (8 + 24 + 64) + 3 * f * (4 + 12 + 72 + 4),
        "steepen": v * (8 + 4 + 32) + 2 * e * 20,
        "displace": e * (12 + 48 + 32 + 32 + 64),
        "centres": f * (24 + 96 + 16),
        "surface_vertices": v * (8 + 32) + 3 * f * (4 + 8 + 48),
        "surface_edges": e * (12 + 8 + 64 + 32 + 16 + 20),
        "mark": r * (4 + 8 + 4) + e * (4 + 8),
        "configure": f * (12 + 12 + 8 + 12),
        "offsets": blocks,
        "place": w * (4 + 32 + 24 + 2 * values)
        + r * 4
        + once * (4 + 8 + 8 + 64 + 32 + 24 + 3 * values)
        + twice * (32 + 48 + 6 * values)
        + look_up,
        "place_centres": f * 4 + centres * (36 + 3 * 44 + 72 + 96 + 24 + 16 + 12),
    }


def report(found: Report) -> str:
    """The text to print."""
    kind = (
        "software, which is no card: compare bytes, not times" if found.is_software else "hardware"
    )
    lines = [
        f"Refinement by kahler-gl on {found.card} ({kind}),",
        f"and by kahler on one core of {found.processor}; medians of interleaved rounds.",
        "card: upload and passes, by timer queries (software: until they end); up: MB of a frame,",
        "and as arrays; moved: MB that passes read and write at least; room: MB of all buffers.",
    ]
    columns = "method:<15|out:9.0f|kahler ms:10.3f|card ms:9.3f|passes:7d|up:8.3f|as arrays:10.3f"
    columns += "|moved:8.2f|room:7.1f"
    for mesh, group in groupby(found.rows, key=lambda row: row.mesh):
        rows = list(group)
        cells = [
            (
                *(row.method, row.triangles_out, row.processor_milliseconds),
                *(row.card_milliseconds, row.dispatches),
                *(1e-6 * row.upload_bytes, 1e-6 * row.arrays_bytes),
                *(1e-6 * row.traffic_bytes, 1e-6 * row.room_bytes),
            )
            for row in rows
        ]
        title = f"{mesh}, {rows[0].triangles_in} triangles"
        lines += ["", title, *table(columns, cells, indent="  ")]
    return "\n".join(lines)
