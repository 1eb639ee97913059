"""Orders of triangles for drawing: they cover what they should, and draw the same picture."""

from __future__ import annotations

import numpy as np
import pytest

import render
from bench.drawing_orders import RESTART, acmr, opposite_sides, strips, tipsify
from bench.sheets import sheet
from bench.strips import drawing, orders_of
from tests import meshes

MESHES = {name: make() for name, make in meshes.NAMED.items() if name != "with_debris"}
MESHES |= {f"irregular {seed}": meshes.irregular(seed, 15, 12) for seed in range(4)}


def turned(triangles: np.ndarray) -> list[tuple[int, ...]]:
    """Triangles with their smallest corner first, sorted: the same however they are written."""
    first = triangles.argmin(axis=1)
    order = (first[:, None] + np.arange(3)) % 3
    return sorted(map(tuple, np.take_along_axis(triangles, order, axis=1).tolist()))


def unstripped(indices: np.ndarray) -> np.ndarray:
    """The triangles of strips, as OpenGL takes them apart: every second one is turned around."""
    found = []
    place = 0
    for a, b, c in zip(indices, indices[1:], indices[2:], strict=False):
        if RESTART in (a, b, c):
            place = 0
            continue
        found.append((a, b, c) if place % 2 == 0 else (b, a, c))
        place += 1
    return np.array(found, dtype=np.int64)


@pytest.mark.parametrize("name", MESHES)
def test_orders_cover_the_mesh(name: str) -> None:
    """Every triangle is there once, with its orientation."""
    mesh = MESHES[name]
    triangles, count = mesh.faces.astype(np.uint32), len(mesh.vertices)
    expected = turned(triangles)
    assert turned(tipsify(triangles, count, 16)) == expected
    assert turned(unstripped(strips(triangles, opposite_sides(triangles, count)))) == expected


def test_strips_are_long() -> None:
    """A grid needs one index and little more per triangle, and many restarts it does not need."""
    grid = meshes.open_grid(30, 30)
    triangles = grid.faces.astype(np.uint32)
    indices = strips(triangles, opposite_sides(triangles, len(grid.vertices)))
    assert len(indices) < 1.2 * len(triangles)


def test_cache_order_misses_less() -> None:
    """In cache order fewer vertices are fetched: close to half a vertex per triangle."""
    mesh = meshes.irregular(5, 40, 40, holes=0)
    triangles, count = mesh.faces.astype(np.uint32), len(mesh.vertices)
    before, after = (
        acmr(order.ravel(), count, len(order), 16)
        for order in (triangles, tipsify(triangles, count, 16))
    )
    assert before > 2.0
    assert after < 0.8


def test_misses_are_counted() -> None:
    """A cache of three forgets the first vertex when a fourth comes; restarts are no vertices."""
    indices = np.array([0, 1, 2, RESTART, 1, 2, 3, 0, 1, 2], dtype=np.uint32)
    assert acmr(indices, 4, 3, 3) == pytest.approx((3 + 1 + 3) / 3)
    assert acmr(indices, 4, 3, 4) == pytest.approx(4 / 3)


def test_all_orders_draw_the_same_picture() -> None:
    """The sheet looks the same in every order, restarts of strips included."""
    load = sheet("2k", 2000, frame_count=1)
    with render.open_offscreen((160, 120), samples=0) as surface:
        pictures = []
        for order in orders_of(load, 1):
            drawing(surface, order)()
            pictures.append(surface.read())
    assert pictures[0].std() > 20.0
    for picture in pictures[1:]:
        assert (picture != pictures[0]).any(axis=2).mean() < 0.002
