"""The programming interfaces of refine/: wrong arguments are ValueError or TypeError."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from risorius import refine

from .refine_inputs import (
    FACES,
    FRAMES,
    MESHES,
    OPTIONS,
    POSITIONS,
    STREAMS,
    VIEWS,
    stream,
)
from .sandbox import bounded

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
MANY = {"loop": {"levels": 2}, "kahler": {}, "none": {}}


@contextmanager
def ends_well(name: str) -> Iterator[None]:
    """Nothing is raised for a name with a star; else an error with words, soon."""
    with bounded():
        if name.startswith("*"):
            yield
            return
        with pytest.raises((ValueError, TypeError)) as refusal:
            yield
    told = str(refusal.value)
    assert 10 < len(told) < 2000, told
    raised_in = refusal.traceback[-1].path.relative_to(ROOT)
    assert raised_in.parts[0] == "refine", told


def sound(mesh: refine.RefinedMesh) -> None:
    """All numbers are numbers, and all triangles have their corners."""
    assert np.isfinite(mesh.positions).all() and np.isfinite(mesh.normals).all()
    assert mesh.triangles.max(initial=0) < max(len(mesh.positions), 1)


@pytest.mark.parametrize("refiner", MANY)
@pytest.mark.parametrize("name", MESHES)
def test_meshes_for_refiners(name: str, refiner: str) -> None:
    """Whatever is bound is whole, or refused."""
    arguments = {"faces": FACES, "rest_positions": POSITIONS, **MESHES[name](), **MANY[refiner]}
    with ends_well(name):
        bound = refine.create(refiner, **arguments)
        rest = np.asarray(arguments["rest_positions"])
        sound(bound.refine(rest if rest.dtype.kind == "f" else rest.astype(float)))


@pytest.mark.parametrize("name", OPTIONS)
def test_options_of_refiners(name: str) -> None:
    """Each is understood, or refused."""
    with ends_well(name):
        sound(refine.create("kahler", FACES, POSITIONS, **OPTIONS[name]).refine(POSITIONS))


@pytest.mark.parametrize("name", ["", "Kahler", "kahler ", None, 3, ["kahler"], b"kahler"])
def test_names_of_refiners(name: object) -> None:
    """There are those that there are."""
    with ends_well("a name"):
        refine.create(name, FACES, POSITIONS)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def refiner() -> refine.Refiner:
    """One that is given wrong frames again and again."""
    return refine.create("kahler", FACES, POSITIONS)


@pytest.mark.parametrize("is_lent", [False, True], ids=["own", "lent"])
@pytest.mark.parametrize("name", FRAMES)
def test_frames(name: str, is_lent: bool, refiner: refine.Refiner) -> None:
    """A wrong frame is refused, and the next good one is as ever."""
    expected = [array.copy() for array in refiner.refine(POSITIONS)[:4]]
    given = FRAMES[name]()
    before = np.array(given).tobytes() if isinstance(given, np.ndarray) else b""
    with ends_well(name):
        sound(refiner.refine(given, out=stream() if is_lent else None))
    assert not before or before == np.array(given).tobytes()
    for array, wanted in zip(refiner.refine(POSITIONS)[:4], expected, strict=True):
        np.testing.assert_array_equal(array, wanted)


@pytest.mark.parametrize("name", STREAMS)
def test_streams(name: str, refiner: refine.Refiner) -> None:
    """Memory that cannot take a frame is never written."""
    with ends_well(name):
        refiner.refine(POSITIONS, out=STREAMS[name]())


@pytest.mark.parametrize("name", VIEWS)
def test_views(name: str) -> None:
    """An eye is a point, and a focal length a number above 0."""
    refiner = refine.create("kahler", FACES, POSITIONS, criterion="silhouette")
    with ends_well(name):
        refiner.refine(POSITIONS, view=VIEWS[name])
