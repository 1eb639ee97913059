"""The head's mesh comes to lie on a surface of other triangles, and stays a sound, even mesh."""

import numpy as np
import pytest

from risorius.assets.fitting.warp import nearest_on
from risorius.assets.model import FloatArray, Head
from risorius.assets.topology import smallest_angles
from risorius.bench.registration import MIRROR, Target, laid_on, relaxed, spread

INSIDE = ("eye_0", "mouth_0", "mouth_1", "nostril", *(f"ear_{k}" for k in range(5)), "concha")
ROWS = ("eye_1", "eye_2", "mouth_2", "mouth_4", "mouth_6", "rim", *INSIDE)


def bent(points: FloatArray) -> FloatArray:
    """A head 4 % larger, its chin forward, its temples narrower: the same on both sides."""
    _, y, z = points.T
    moved = 1.04 * points
    moved[:, 2] += 4.0 * np.exp(-(((y + 95.0) / 35.0) ** 2)) * (z > 0.0)
    moved[:, 0] *= 1.0 - 0.05 * np.exp(-(((y - 30.0) / 40.0) ** 2))
    return np.asarray(moved)


def row_vertices(head: Head, names: tuple[str, ...]) -> list[int]:
    """Numbers of the vertices of some rows of both sides."""
    sides = ("left", "right")
    return sorted({int(v) for n in names for s in sides for v in head.rings[f"{n}_{s}"]})


@pytest.fixture(scope="module")
def surface(head: Head) -> Target:
    """The bent head, of four times the triangles."""
    fine = head.finer(1)
    return Target(bent(fine.vertices), fine.faces)


@pytest.fixture(scope="module")
def laid(head: Head, surface: Target) -> FloatArray:
    """The head's vertices on it."""
    known = row_vertices(head, ROWS)
    targets = {v: (bent(head.vertices[[v]])[0], 1.0) for v in known}
    free = np.setdiff1d(np.arange(len(head.vertices)), row_vertices(head, INSIDE))
    return laid_on(head, head.vertices, surface, targets, free.astype(np.int32))


def test_vertices_come_to_lie_on_the_surface(head: Head, surface: Target, laid: FloatArray) -> None:
    """They are off it by tenths of a millimetre, where the start was off by millimetres."""

    def off(x: FloatArray) -> float:
        at = nearest_on(x, np.zeros_like(x), surface.vertices, surface.triangles)
        away = np.linalg.norm(at.interpolate(surface.vertices) - x, axis=1)
        return float(np.sqrt((away**2).mean()))

    assert off(head.vertices) > 1.5
    assert off(laid) < 0.25


def test_both_sides_stay_alike(head: Head, laid: FloatArray) -> None:
    """Each vertex is the mirror image of its partner."""
    assert laid[head.mirror] * MIRROR == pytest.approx(laid, abs=1e-9)


def test_narrow_triangles_are_relaxed(head: Head, surface: Target, laid: FloatArray) -> None:
    """Vertices that were pushed aside slide apart again, along the surface and evenly."""
    inside = row_vertices(head, ROWS)
    lying = np.setdiff1d(np.arange(len(laid)), inside).astype(np.int32)
    pushed = laid.copy()
    face = head.faces[np.isin(head.faces, lying).all(axis=1)][40]
    pushed[face[0]] += 0.9 * (pushed[face[1:]].mean(axis=0) - pushed[face[0]])
    pushed[head.mirror[face[0]]] = pushed[face[0]] * MIRROR
    assert smallest_angles(pushed, head.faces).min() < 11.0
    slid = relaxed(head, pushed, surface, lying, 14.0)
    assert smallest_angles(slid, head.faces).min() > 12.0
    assert slid[head.mirror] * MIRROR == pytest.approx(slid, abs=1e-9)


def test_fields_spread_smoothly(head: Head) -> None:
    """What is known stays, and a field that is the same everywhere is so where it is not known."""
    fields = np.tile([0.0, 2.0, -1.0], (1, len(head.vertices), 1))
    known = np.arange(0, len(head.vertices), 3, dtype=np.int32)
    known = np.union1d(known, head.mirror[known]).astype(np.int32)
    told = fields.copy()
    told[:, np.setdiff1d(np.arange(len(head.vertices)), known)] = 0.0
    assert spread(head, head.vertices, told, known) == pytest.approx(fields, abs=1e-6)
