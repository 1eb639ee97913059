"""Values given with each frame are refined like attributes."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from risorius import refine
from tests import meshes
from tests.refine.cases import places_in_source, soups

REFINERS = {
    "none": ("none", {}),
    "loop": ("loop", {"levels": 2}),
    "paper": ("kahler", {}),
    "coherent": ("kahler", {"coherent": True}),
    "cubic": ("kahler", {"scheme": "cubic"}),
    "blended": ("kahler", {"blend": True}),
    "card": ("kahler-gl", {"scheme": "cubic"}),
    "card, paper": ("kahler-gl", {}),
}


def bound(name, options, mesh, heat, colours):
    """A refiner with heat at vertices, colours at corners, and texture coordinates."""
    attributes = {"heat": heat, "colour": (colours, mesh.corner_rows)}
    return refine.create(
        name, mesh.faces, mesh.vertices, mesh.uv, mesh.face_uv, attributes=attributes, **options
    )


class Seamed:
    """A tube with one seam of texture coordinates, and another seam of colours."""

    def __init__(self):
        tube = meshes.tube(10, 6)
        self.vertices = tube.vertices
        self.faces = tube.faces
        self.uv = tube.uv
        self.face_uv = tube.face_uv
        self.corner_rows = np.random.default_rng(4).integers(5, size=tube.faces.shape)
        self.frames = [meshes.wrinkled(tube, seed, 0.3) for seed in (3, 4, 5)]


@pytest.mark.parametrize("look", REFINERS)
def test_as_if_bound_anew(look):
    """Each frame with values equals, to the bit, a frame of a new refiner bound with these values.

    A frame without values uses the bound values again.
    """
    mesh = Seamed()
    name, options = REFINERS[look]
    generator = np.random.default_rng(7)
    heats = generator.random((3, len(mesh.vertices), 1)).astype(np.float32)
    colours = generator.random((5, 4)).astype(np.float32)
    others = generator.random((5, 4)).astype(np.float32)
    refiner = bound(name, options, mesh, heats[0], colours)
    given = [None, {"heat": heats[1]}, {"heat": heats[2], "colour": others}, None]
    for frame, values in zip([*mesh.frames, mesh.frames[0]], given, strict=True):
        values = values or {}
        refined = refiner.refine(frame, values=values or None)
        refine.check(refiner, refined, frame)
        anew = bound(
            name, options, mesh, values.get("heat", heats[0]), values.get("colour", colours)
        ).refine(frame)
        if not options.get("coherent"):  # coherent triangles depend on earlier frames
            assert refined.triangles.tobytes() == anew.triangles.tobytes()
        assert refined.positions.tobytes() == anew.positions.tobytes()
        assert refined.uv is not None and refined.uv.tobytes() == anew.uv.tobytes()
        for each in ("heat", "colour"):
            assert refined.attributes[each].tobytes() == anew.attributes[each].tobytes()


@settings(max_examples=40, deadline=None)
@given(case=soups(), seed=st.integers(0, 99), look=st.sampled_from(["paper", "cubic", "coherent"]))
def test_linear_within_triangles(case, seed, look):
    """On any triangles values are exact at vertices, and linear between them."""
    positions, faces = case
    name, options = REFINERS[look]
    generator = np.random.default_rng(seed)
    heat = generator.uniform(-9.0, 9.0, (len(positions), 2)).astype(np.float32)
    refiner = refine.create(
        name, faces, positions, attributes={"heat": np.zeros_like(heat)}, **options
    )
    moved = positions + generator.uniform(-0.4, 0.4, positions.shape)
    refined = refiner.refine(moved, values={"heat": heat})
    found = refined.attributes["heat"]
    used = np.unique(faces)
    assert_array_equal(found[used], heat[used])
    is_proper = np.array([len(set(face)) == 3 for face in faces.tolist()], dtype=bool)
    shown = is_proper[refined.source]
    triangles = refined.triangles[shown]
    source = refined.source[shown]
    places = places_in_source(refiner.origins(), triangles, faces[source])
    expected = np.einsum("tci,tiu->tcu", places, heat[faces[source]])
    assert_allclose(found[triangles], expected, rtol=0, atol=1e-5)


def test_one_topology():
    """With fixed splits, vertices and triangles stay the same while values change."""
    mesh = Seamed()
    heat = np.zeros((len(mesh.vertices), 1))
    colours = np.zeros((5, 4))
    splits = refine.splits_of_clip(bound("kahler", {}, mesh, heat, colours), mesh.frames)
    refiner = bound("kahler", {"splits": splits}, mesh, heat, colours)
    heights = []
    for k, frame in enumerate(mesh.frames):
        refined = refiner.refine(frame, values={"heat": heat + k})
        assert len(refined.triangles) == refiner.triangle_capacity
        assert_array_equal(refined.attributes["heat"], float(k))
        heights.append(refined.triangles.tobytes())
    assert heights[0] == heights[1] == heights[2]


@pytest.mark.parametrize("look", ["paper", "cubic", "none"])
def test_nothing_is_kept_of_frames(look):
    """A hundred frames with values add no memory, and use the same arrays.

    Other threads of a test worker sometimes allocate, so the smallest of three growths counts.
    """
    mesh = Seamed()
    name, options = REFINERS[look]
    refiner = bound(name, options, mesh, np.zeros((len(mesh.vertices), 1)), np.zeros((5, 4)))
    heat = np.ones((len(mesh.vertices), 1), np.float32)

    def run(count):
        for k in range(count):
            refined = refiner.refine(mesh.frames[k % 3], values={"heat": heat * k})
        return refined.attributes["heat"].base

    first = run(6)
    growths = []
    tracemalloc.start()
    try:
        run(6)
        for _ in range(3):
            before, _ = tracemalloc.get_traced_memory()
            assert run(99) is first
            after, _ = tracemalloc.get_traced_memory()
            growths.append(after - before)
    finally:
        tracemalloc.stop()
    assert min(growths) < 20_000


def test_mistakes_are_reported():
    """An unbound name, another shape, and NaN are refused; the next frame is correct."""
    mesh = meshes.tube(6, 4)
    heat = np.zeros((len(mesh.vertices), 1), np.float32)
    plain = refine.create("kahler", mesh.faces, mesh.vertices)
    with pytest.raises(
        ValueError, match=r"values\['heat'\] is not an attribute .* no attribute was"
    ):
        plain.refine(mesh.vertices, values={"heat": heat})
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, attributes={"heat": heat})
    with pytest.raises(ValueError, match=r"'cold'.* bound are \['heat'\]"):
        refiner.refine(mesh.vertices, values={"cold": heat})
    with pytest.raises(ValueError, match=r"values\['heat'\] must be numbers of shape"):
        refiner.refine(mesh.vertices, values={"heat": heat[1:]})
    bad = heat.astype(np.float64)
    bad[2] = 1e200
    with pytest.raises(ValueError, match="finite as single precision, but row 2 is"):
        refiner.refine(mesh.vertices, values={"heat": bad})
    assert not refiner.refine(mesh.vertices).attributes["heat"].any()
