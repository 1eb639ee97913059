"""Fixed splits: given splits for all frames, and the splits that all frames of a clip need."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from risorius.geometry.directions import unit_vectors
from tests import meshes
from tests.refine.cases import Forced, GivenMetric, edge_count_of, kahler, sound_frame, soups

OPTIONS_OF_LOOKS: dict[str, dict[str, Any]] = {
    "paper": {},
    "paper, blended": {"blend": True},
    "paper, refined normals": {"normals": "refined"},
    "coherent": {"coherent": True},
    "cubic": {"scheme": "cubic"},
    "cubic, not blended": {"scheme": "cubic", "blend": False},
    "creases": {"scheme": "cubic", "crease_angle": 40.0},
}


def arrays_of(mesh):
    """All arrays of a frame, as bytes."""
    extra = [] if mesh.uv is None else [mesh.uv]
    return [each.tobytes() for each in (*mesh[:4], *extra, *mesh.attributes.values())]


@st.composite
def clips(draw):
    """Random triangles, with or without seams, and three frames of positions."""
    positions, faces = draw(soups())
    generator = np.random.default_rng(draw(st.integers(0, 2**16)))
    frames = [positions + generator.uniform(-0.4, 0.4, positions.shape) for _ in range(3)]
    if not draw(st.booleans()):
        return meshes.Mesh(positions, faces), frames
    uv = generator.random((5, 2))
    face_uv = generator.integers(0, 5, faces.shape).astype(np.int32)
    return meshes.Mesh(positions, faces, uv, face_uv), frames


@pytest.mark.parametrize("look", OPTIONS_OF_LOOKS)
@settings(max_examples=25, deadline=None)
@given(clip=clips())
def test_a_clip_of_any_triangles(look, clip):
    """With the splits of a clip no frame has a crack or T-junction, and all have one topology.

    Each edge is split at least as often as any frame needs.
    """
    mesh, frames = clip
    inputs = [mesh.faces, mesh.vertices, *frames]
    before = [array.tobytes() for array in inputs]
    changing = kahler(mesh, **OPTIONS_OF_LOOKS[look])
    splits = refine.splits_of_clip(changing, frames)
    fixed = kahler(mesh, splits=splits, **OPTIONS_OF_LOOKS[look])
    seen = []
    for frame in frames:
        refined = sound_frame(fixed, frame)
        changing.refine(frame)
        assert (changing.splits <= fixed.splits).all()
        assert (fixed.splits == splits).all()
        origins = fixed.origins()
        topology = (refined.triangles, refined.source, origins.vertices, origins.weights)
        seen.append([array.tobytes() for array in topology])
    assert seen[0] == seen[1] == seen[2]
    assert [array.tobytes() for array in inputs] == before


@pytest.mark.parametrize("look", [name for name in OPTIONS_OF_LOOKS if name != "coherent"])
def test_a_frame_has_the_bits_of_one_that_decides(look):
    """A frame with given splits equals a frame whose criterion makes the same splits, to the bit.

    All attributes are equal, too.
    """
    mesh = meshes.irregular(7)
    generator = np.random.default_rng(8)
    splits = generator.integers(0, 3, edge_count_of(mesh))
    heat = {"heat": generator.random((len(mesh.vertices), 1))}
    options = {**OPTIONS_OF_LOOKS[look], "attributes": heat}
    fixed = kahler(mesh, splits=splits, **options)
    grown = np.where(splits > 0, splits, -np.inf)
    deciding = kahler(mesh, criterion=GivenMetric(grown), **options)
    for seed in range(3):
        frame = meshes.wrinkled(mesh, seed)
        assert arrays_of(fixed.refine(frame)) == arrays_of(deciding.refine(frame))


@pytest.mark.parametrize("splits", [1, 2])
def test_bits_among_many_neighbours_and_on_a_folded_sheet(splits):
    """Frames have the same bits with given splits and with a criterion, also in two hard cases.

    The cases are vertices with many neighbours, and opposite normals.
    """
    cone = meshes.double_cone(12)
    sheet = meshes.open_grid(6, 5)
    flipped = sheet.vertices.copy()
    flipped[flipped[:, 0] > 2.5, 1] *= -1.0
    folded = sheet.vertices.copy()
    folded[:, 0] = np.abs(folded[:, 0] - 2.5)
    for mesh, frame in ((cone, meshes.wrinkled(cone, 1)), (sheet, flipped), (sheet, folded)):
        edges = refine.connect(mesh.faces, len(mesh.vertices)).edges
        wanted = np.full(len(edges), splits)
        fixed = kahler(mesh, splits=wanted)
        deciding = kahler(mesh, criterion=GivenMetric(wanted))
        assert arrays_of(fixed.refine(frame)) == arrays_of(deciding.refine(frame))


def test_a_matrix_moves_every_point_and_normal():
    """Each first-level point is the mean of vertices with weights 3/8, 3/8, 1/8, 1/8, as by numpy.

    Its normal is the mean of the normals at both ends.
    """
    ball = meshes.ball(2)
    around = refine.connect(ball.faces, len(ball.vertices)).around
    fixed = kahler(ball, splits=np.ones(len(around.points), int))
    frame = meshes.wrinkled(ball, 1)
    refined = fixed.refine(frame)
    a, b, c, d = (frame[around.points[:, i]] for i in range(4))
    middles = (3.0 * (a + b) + c + d) / 8.0
    assert np.abs(refined.positions[len(frame) :] - middles).max() < 1e-6
    normals = refined.normals[: len(frame)]
    means = normals[around.points[:, 0]] + normals[around.points[:, 1]]
    means = unit_vectors(means)
    assert np.abs(refined.normals[len(frame) :] - means).max() < 1e-6


def test_capacities_are_those_of_a_frame():
    """A stream with exactly the size of a frame is enough, and every frame fills it."""
    mesh = meshes.irregular(7)
    frames = [meshes.wrinkled(mesh, seed) for seed in range(3)]
    fixed = kahler(mesh, splits=refine.splits_of_clip(kahler(mesh), frames))
    shown = fixed.refine(frames[0])
    assert fixed.vertex_capacity == len(shown.positions)
    assert fixed.triangle_capacity == len(shown.triangles)
    lent = refine.StreamArrays(
        np.zeros((fixed.vertex_capacity, 6), np.float32),
        np.zeros((fixed.triangle_capacity, 3), np.uint32),
        np.zeros(fixed.triangle_capacity, np.int32),
    )
    for frame in frames:
        own = arrays_of(fixed.refine(frame))
        for array in lent:
            array[:] = 7
        assert arrays_of(fixed.refine(frame, out=lent)) == own
        assert arrays_of(fixed.refine(frame)) == own


def test_triangles_are_found_once():
    """A criterion that never changes is called once, and the triangles are read-only."""

    class Counting(Forced):
        is_constant = True
        calls = 0

        def mark(self, positions, normals, splits):
            self.calls += 1
            super().mark(positions, normals, splits)

    mesh = meshes.irregular(7)
    edge_count = edge_count_of(mesh)
    criterion = Counting(np.arange(edge_count) % 3)
    refiner = kahler(mesh, criterion=criterion)
    for seed in range(3):
        refined = refiner.refine(meshes.wrinkled(mesh, seed))
        with pytest.raises(ValueError, match="read-only"):
            refined.triangles[0] = 0
    assert criterion.calls == 1


def test_the_criterion_rest_keeps_its_triangles():
    """With the criterion `rest` triangles stay the same; with `rest+normal` they change."""
    ball = meshes.ball(3)
    frame = meshes.wrinkled(ball, 1)
    assert kahler(ball, criterion="rest").topology is not None
    both = kahler(ball, criterion="rest+normal")
    assert both.topology is None
    assert len(both.refine(frame).triangles) > len(both.refine(ball.vertices).triangles)


def test_a_view_decides_as_well():
    """The splits of a clip depend on the given view."""
    ball = meshes.ball()
    changing = kahler(ball, criterion="silhouette")
    view = refine.View((0.0, 0.0, 4.0))
    splits = refine.splits_of_clip(changing, [ball.vertices], view)
    assert splits.any()
    assert (splits == changing.splits).all()
    assert not refine.splits_of_clip(changing, []).any()


@pytest.mark.parametrize(
    ("splits", "error"),
    [
        ([0, 1], "a number for each of the 12 edges of this mesh .refiner.edges., got 2"),
        (np.full(12, 3), "splits must be 0, 1 or 2 for every edge.*but edge 0 has 3"),
        (np.full(12, -1), "but edge 0 has -1"),
        (np.zeros(12), "got float64 of shape .12,."),
        (np.zeros((12, 1), int), "got int64 of shape .12, 1."),
        ([[1], [1, 2]], "but is not an array"),
    ],
)
def test_mistakes_are_reported(splits, error):
    """Splits of another mesh, shape, type or size are refused; the error has the right ones."""
    with pytest.raises(ValueError, match=error):
        kahler(meshes.octahedron(), splits=splits)


def test_splits_and_a_criterion_exclude_each_other():
    """Splits and a criterion exclude each other, because both determine how edges are split."""
    with pytest.raises(ValueError, match=r"splits= and criterion= .*; pass one of the two"):
        kahler(meshes.octahedron(), splits=np.zeros(12, int), criterion="rest")
