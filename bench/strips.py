"""What triangle strips or an order for the vertex cache are worth in drawing today.

Kähler, Haber, Seidel 2003, section 6: "refined meshes could be converted to triangle strips". The
refined mesh of one frame is drawn offscreen, on whatever OpenGL there is, in the orders of
drawing_orders.py. Each costs its conversion anew in every frame, because the triangles are new; the
only order that costs nothing is one of the input, which its subtriangles follow.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import refine
import render

from .drawing_orders import CACHE_SIZE, acmr, opposite_sides, strips, tipsify
from .refine import SHARES, load_of, thresholds_of
from .sheets import Load
from .timing import interleaved

Unsigned = npt.NDArray[np.uint32]

SIZES = ("face", "200k", "200k shuffled", "1M")
FRAME = (1280, 720)  # pixels
CACHES = (16, 32)
SEED = 2003
VERTEX_SHADER = """
#version 330
uniform vec3 centre;
uniform vec3 scale;
in vec3 in_position;
in vec3 in_normal;
out vec3 normal;
void main() {
    gl_Position = vec4((in_position - centre) * scale, 1.0);
    normal = in_normal;
}
"""
FRAGMENT_SHADER = """
#version 330
in vec3 normal;
out vec4 colour;
void main() {
    colour = vec4(vec3(0.2 + 0.8 * abs(normalize(normal).z)), 1.0);
}
"""


@dataclass(frozen=True)
class Row:
    """One order of the triangles of one mesh."""

    mesh: str
    order: str
    triangles: int
    misses: tuple[float, ...]
    """Misses per triangle of caches with 16 and with 32 entries."""
    megabytes: float
    """Of indices."""
    making: float
    """Time to refine a frame and to bring its triangles into this order [ms], median."""
    drawing: float
    """Time to hand the indices over and draw [ms], median."""


@dataclass(frozen=True)
class Order:
    """The triangles of a frame as they are to be drawn."""

    name: str
    rows: npt.NDArray[np.float32]
    """x y z, nx ny nz of the vertices, shape (N, 6)."""
    indices: Unsigned
    making: float
    """Time it took [ms]."""
    is_strip: bool = False


def run(
    *,
    sizes: Sequence[str] = SIZES,
    rounds: int = 9,
    progress: Callable[[str], object] = lambda _: None,
) -> tuple[str, list[Row]]:
    """Measure each of `sizes`; returns the name of the device that draws, and the rows."""
    rows: list[Row] = []
    with render.open_offscreen(FRAME, samples=0) as surface:
        for size in sizes:
            progress(size)
            load = load_of(size)
            rows += _drawn(surface, load.name, orders_of(load, rounds), rounds)
        return str(surface.gl.info["GL_RENDERER"]), rows


def orders_of(load: Load, rounds: int) -> list[Order]:
    """Refine the first frame of a mesh, and convert it into each order."""
    thresholds = {}
    if load.name != "face":
        once, twice = thresholds_of(load, {10: SHARES[10]})[10]
        thresholds = {"threshold_once": once, "threshold_twice": twice}
    walked = tipsify(load.faces.astype(np.uint32), len(load.rest), CACHE_SIZE).astype(np.int32)
    as_given = refine.create("kahler", load.faces, load.rest, **thresholds)
    in_cache_order = refine.create("kahler", walked, load.rest, **thresholds)
    frame = load.frames[0]
    rows, triangles = _output(as_given.refine(frame))
    other_rows, other_triangles = _output(in_cache_order.refine(frame))
    count = len(rows)
    converted = [
        tipsify(triangles, count, CACHE_SIZE),
        strips(triangles, opposite_sides(triangles, count)),
    ]
    calls: list[Callable[[], object]] = [
        lambda: as_given.refine(frame),
        lambda: in_cache_order.refine(frame),
        lambda: tipsify(triangles, count, CACHE_SIZE),
        lambda: strips(triangles, opposite_sides(triangles, count)),
    ]
    plain, other, cache, strip = 1e3 * np.median(interleaved(calls, rounds), axis=0)
    at_random = triangles[np.random.default_rng(SEED).permutation(len(triangles))]
    return [
        Order("as refined", rows, triangles, plain),
        Order("input in cache order", other_rows, other_triangles, other),
        Order("cache order", rows, converted[0], plain + cache),
        Order("strips", rows, converted[1], plain + strip, is_strip=True),
        Order("at random", rows, at_random, plain),
    ]


def _output(mesh: refine.RefinedMesh) -> tuple[npt.NDArray[np.float32], Unsigned]:
    return np.concatenate([mesh.positions, mesh.normals], axis=1), mesh.triangles.copy()


def _drawn(surface: render.Surface, name: str, orders: Sequence[Order], rounds: int) -> list[Row]:
    """Draw the orders in turn, and tell what is known of each."""
    calls = [drawing(surface, order) for order in orders]
    for call in calls:
        call()
    times = 1e3 * np.median(interleaved(calls, rounds), axis=0)
    count = len(orders[0].indices)
    rows = []
    for order, milliseconds in zip(orders, times, strict=True):
        indices = order.indices.reshape(-1)
        misses = tuple(acmr(indices, len(order.rows), count, entries) for entries in CACHES)
        megabytes = 1e-6 * indices.nbytes
        rows.append(
            Row(name, order.name, count, misses, megabytes, order.making, float(milliseconds))
        )
    return rows


def drawing(surface: render.Surface, order: Order) -> Callable[[], None]:
    """Return a call that uploads the indices and draws the frame, filling the picture."""
    gl = surface.gl
    low, high = order.rows[:, :3].min(axis=0), order.rows[:, :3].max(axis=0)
    program = gl.program(vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER)
    program["centre"] = tuple(0.5 * (low + high))
    program["scale"] = tuple(np.array([1.9, 1.9, -1.9]) / np.maximum(high - low, 1e-6))
    indices = gl.buffer(order.indices, dynamic=True)
    array = gl.vertex_array(
        program,
        [(gl.buffer(order.rows), "3f 3f", "in_position", "in_normal")],
        index_buffer=indices,
        index_element_size=4,
    )
    mode = gl.TRIANGLE_STRIP if order.is_strip else gl.TRIANGLES

    def draw() -> None:
        surface.begin()
        indices.orphan()
        indices.write(order.indices)
        array.render(mode, vertices=order.indices.size)
        gl.finish()

    return draw
