"""Arrays that never change are read-only, so that a mistaken `+=` raises an error."""

import enum
import types
from collections.abc import Mapping

import numpy as np
import pytest

from risorius import assets, refine, sim
from risorius.app.scenes import FaceScene, PlaneScene
from risorius.assets.fitting import fit
from risorius.refine.kahler.table import CONFIGURATION_TABLE
from tests.heads import person_of, user_head

OF_A_FRAME = {"positions", "points", "normals", "edge_splits"}
"""Arrays of a refiner that subclasses may write: each frame writes all of them again."""
PLAIN_TYPES = (str, bytes, int, float, bool, np.generic, type, types.ModuleType, enum.Enum)


def arrays_of(thing, name, seen):
    """All arrays reached by public attributes, items and rows, each with its path."""
    if thing is None or id(thing) in seen or isinstance(thing, PLAIN_TYPES) or callable(thing):
        return
    seen[id(thing)] = thing  # kept alive, so that no other object gets its id
    if isinstance(thing, np.ndarray):
        yield name, thing
    elif isinstance(thing, Mapping):
        for key, value in thing.items():
            yield from arrays_of(value, f"{name}[{key!r}]", seen)
    elif isinstance(thing, list | tuple | set | frozenset) and not hasattr(thing, "_fields"):
        for number, value in enumerate(thing):
            yield from arrays_of(value, f"{name}[{number}]", seen)
    elif type(thing).__module__.partition(".")[0] == "risorius":
        for attribute in dir(thing):
            if attribute.startswith("_") or not is_kept(thing, attribute):
                continue
            value = getattr(thing, attribute)
            yield from arrays_of(value, f"{name}.{attribute}", seen)


def is_kept(thing, name):
    """Whether an attribute can be read, and is the same object when read again."""
    try:
        first = getattr(thing, name)
        second = getattr(thing, name)
    except Exception:  # attributes that this head does not have, or not yet
        return False
    if isinstance(first, np.ndarray):
        return np.shares_memory(first, second)
    return first is second


def own_head():
    """A user's head."""
    brought = user_head()
    return fit(brought.mesh, brought.landmarks)


READ_ONLY_OBJECTS = {
    "head": lambda head: head,
    "finer": lambda head: head.finer(1),
    "plane": lambda head: assets.load("plane"),
    "own head": lambda head: own_head(),
    "own mesh": lambda head: user_head().mesh,
    "person": lambda head: person_of(63),
    "simulation": sim.create,
    "moved simulation": lambda head: moved(head),
    "face": lambda head: FaceScene(),
    "person's face": lambda head: FaceScene(person_of(63)),
    "sine": lambda head: PlaneScene(),
    "connectivity": lambda head: refine.connect(head.faces, len(head.vertices)),
    "welded": lambda head: refine.WeldedRefiner(head.vertices, head.faces),
    "table": lambda head: CONFIGURATION_TABLE,
}
REFINERS = {
    "none": ("none", {}),
    "loop": ("loop", {"levels": 2}),
    "paper": ("kahler", {}),
    "coherent": ("kahler", {"coherent": True}),
    "window": ("kahler", {"scheme": "cubic", "criterion": "displacement+rest+normal"}),
    "card": ("kahler-gl", {}),
}


def moved(head):
    """A face with moved jaw, lips and head."""
    simulation = sim.create(head)
    simulation.jump({"jaw_open": 0.5, "lips_closed": 0.5, "head_yaw": 0.3})
    simulation.step(1 / 60)
    return simulation


@pytest.mark.parametrize("name", READ_ONLY_OBJECTS)
def test_nothing_of_it_can_be_written(name, head):
    """All arrays reached by public attributes of heads and faces are read-only."""
    found = dict(arrays_of(READ_ONLY_OBJECTS[name](head), name, {}))
    assert found
    assert [way for way, array in found.items() if array.flags.writeable] == []


@pytest.mark.parametrize("name", REFINERS)
def test_nothing_of_a_refiner_can_be_written(name, head):
    """The only writable arrays of a refiner are those written in each frame."""
    kind, options = REFINERS[name]
    refiner = refine.create(kind, head.faces, head.vertices, head.uv, head.face_uv, **options)
    refiner.refine(head.vertices)
    found = dict(arrays_of(refiner, "", {}))
    assert len(found) > 10
    writable = [way for way, array in found.items() if array.flags.writeable]
    assert {way.removeprefix(".") for way in writable} <= OF_A_FRAME


def test_one_in_place_addition_harms_nobody(head):
    """Vertex indices for compiled code are read-only, with numpy's own error."""
    simulation = sim.create(head)
    refiner = refine.create("kahler", simulation.faces, simulation.rest_positions, coherent=True)
    for array in (
        simulation.faces,
        refiner.edges,
        refiner.triangle_edges,
        refiner.connectivity.corners,
        refiner.connectivity.around.points,
        refiner.cutting.states,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array += 1
