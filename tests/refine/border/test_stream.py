"""Streams: lent arrays are filled in place and checked, and frames allocate nothing."""

import copy
import gc
import pickle
import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest

from risorius import refine
from tests import meshes
from tests.refine.cases import kahler, scheme_of

REFINERS = [("none", {}), ("kahler", {}), ("loop", {"levels": 1}), ("loop", {"levels": 2})]


def stream_for(refiner, spare=0):
    """A lent stream with exactly the required room, or with some more rows."""
    rows = refiner.triangle_capacity + spare
    shape = (refiner.vertex_capacity + spare, refiner.vertex_columns)
    return SimpleNamespace(
        vertices=np.full(shape, np.nan, dtype=np.float32),
        triangles=np.full((rows, 3), 2**32 - 1, dtype=np.uint32),
        source=np.full(rows, -1, dtype=np.int32),
    )


@pytest.mark.parametrize("spare", [0, 10])
@pytest.mark.parametrize(("name", "options"), REFINERS)
@pytest.mark.parametrize("textured", [False, True])
def test_lent_stream(name, options, textured, spare):
    """A lent stream gets the same values as the refiner's own, and the mesh is a view of it."""
    tube = meshes.tube(10, 6)
    texture = {"uv": tube.uv, "face_uv": tube.face_uv} if textured else {}
    deformed = meshes.wrinkled(tube, 3)
    refiner = refine.create(name, tube.faces, tube.vertices, **texture, **options)
    own = [None if array is None else array.copy() for array in refiner.refine(deformed)[:5]]
    stream = stream_for(refiner, spare)
    lent = refiner.refine(deformed, out=stream)
    for ours, theirs in zip(lent[:5], own, strict=True):
        assert (ours is None) == (theirs is None)
        assert ours is None or theirs is None or ours.tobytes() == theirs.tobytes()
    assert np.shares_memory(lent.positions, stream.vertices)
    assert np.shares_memory(lent.normals, stream.vertices)
    assert np.shares_memory(lent.triangles, stream.triangles)
    assert np.shares_memory(lent.source, stream.source)
    assert (stream.triangles[len(lent.triangles) :] == 2**32 - 1).all()
    assert (stream.source[len(lent.source) :] == -1).all()
    assert np.isnan(stream.vertices[len(lent.positions) :]).all()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (
            {"vertices": np.zeros((5, 6), np.float32)},
            r"stream.vertices .* \(>= 665, 6\), got float",
        ),
        ({"vertices": np.zeros((999, 8), np.float32)}, r"got float32 of shape \(999, 8\)"),
        ({"vertices": np.zeros((999, 6))}, "got float64"),
        ({"vertices": np.zeros((999, 12), np.float32)[:, ::2]}, "not contiguous"),
        ({"vertices": [0.0]}, "got list"),
        ({"triangles": np.zeros((9999, 3), np.int32)}, "stream.triangles must be .* uint32"),
        ({"triangles": np.zeros((3, 3), np.uint32)}, r"shape \(>= 1200, 3\)"),
        ({"source": np.zeros(3, np.int32)}, r"stream.source .* shape \(>= 1200\)"),
        ({"source": np.zeros((9999, 1), np.int32)}, "stream.source"),
    ],
)
def test_bad_stream(change, text):
    """A stream too small for the worst case is refused, and nothing is written."""
    grid = meshes.open_grid(10, 6)
    refiner = kahler(grid)
    assert refiner.triangle_capacity == 1200
    stream = stream_for(refiner)
    for name, array in change.items():
        setattr(stream, name, array)
    with pytest.raises(ValueError, match=text):
        refiner.refine(grid.vertices, out=stream)


@pytest.mark.parametrize("name", ["vertices", "triangles", "source"])
def test_stream_that_becomes_read_only(name):
    """Arrays made read-only between two frames are not written."""
    mesh = meshes.irregular(2)
    refiner = kahler(mesh)
    stream = stream_for(refiner)
    refiner.refine(mesh.vertices, out=stream)
    array = getattr(stream, name)
    before = array.tobytes()
    array.flags.writeable = False
    with pytest.raises(ValueError, match=rf"stream.{name} .* read-only"):
        refiner.refine(meshes.wrinkled(mesh, 1), out=stream)
    assert array.tobytes() == before


def test_any_row_of_streams():
    """With streams in random order, each frame is written into its own stream only."""
    mesh = meshes.irregular(3)
    refiner = kahler(mesh)
    frames = [mesh.vertices + amount * (meshes.wrinkled(mesh, 4) - mesh.vertices)
              for amount in (0.0, 0.3, 1.0)]  # fmt: skip
    streams = [None, *(stream_for(refiner) for _ in range(3))]
    fresh = [kahler(mesh).refine(frame) for frame in frames]
    assert len({len(frame.triangles) for frame in fresh}) == 3
    rng = np.random.default_rng(5)
    kept = {}
    for _ in range(60):
        k = int(rng.integers(3))
        stream = streams[int(rng.integers(4))]
        if stream is not None and rng.random() < 0.1:
            stream.triangles = stream.triangles.copy()
        refined = refiner.refine(frames[k], out=stream)
        frame = [np.ascontiguousarray(part).tobytes() for part in refined[:4]]
        assert frame == [np.ascontiguousarray(part).tobytes() for part in fresh[k][:4]]
        for other in streams:
            if other is not stream and id(other) in kept and other is not None:
                assert [other.vertices.tobytes(), other.triangles.tobytes()] == kept[id(other)]
        if stream is not None:
            kept[id(stream)] = [stream.vertices.tobytes(), stream.triangles.tobytes()]


def test_stream_may_be_the_input():
    """Positions that lie in the lent stream are read before they are overwritten."""
    mesh = meshes.irregular(2)
    deformed = meshes.wrinkled(mesh, 3).astype(np.float32)
    refiner = kahler(mesh)
    expected = refiner.refine(deformed).positions.copy()
    stream = stream_for(refiner)
    stream.vertices[: len(deformed), 0:3] = deformed
    mesh_in_place = refiner.refine(stream.vertices[: len(deformed), 0:3], out=stream)
    assert (mesh_in_place.positions == expected).all()


@pytest.mark.parametrize(("name", "options"), REFINERS)
@pytest.mark.parametrize("textured", [False, True])
def test_nothing_is_allocated(name, options, textured):
    """After the first frames, only views and restarted passes allocate memory.

    Other threads of a test worker sometimes allocate, so the smallest of three measurements counts.
    """
    tube = meshes.tube(40, 30)
    texture = {"uv": tube.uv, "face_uv": tube.face_uv} if textured else {}
    refiner = refine.create(name, tube.faces, tube.vertices, **texture, **options)
    frames = [meshes.wrinkled(tube, seed) for seed in range(4)]
    stream = stream_for(refiner)
    for deformed in frames:
        refiner.refine(deformed, out=stream)
        refiner.refine(deformed)
    gc.collect()
    tracemalloc.start()
    taken = np.zeros((3, len(frames), 2))
    for each_time in taken:
        for of_frame, deformed in zip(each_time, frames, strict=True):
            for place, lent in enumerate((stream, None)):
                before, _ = tracemalloc.get_traced_memory()
                tracemalloc.reset_peak()
                refiner.refine(deformed, out=lent)
                of_frame[place] = tracemalloc.get_traced_memory()[1] - before
    tracemalloc.stop()
    assert taken.min(axis=0).max() < 16384  # positions alone are 30 kB


@pytest.mark.parametrize(
    "positions", [np.zeros((5, 3)), np.zeros((6, 2)), np.zeros(18), np.zeros((6, 3), dtype=int)]
)
def test_bad_positions(positions):
    """Positions of another mesh, and integers, are refused.

    The error has the expected type and shape.
    """
    mesh = meshes.octahedron()
    refiner = refine.create("none", mesh.faces, mesh.vertices)
    with pytest.raises(ValueError, match=r"positions must be floats of shape \(6, 3\) .*, got"):
        refiner.refine(positions)


def test_masked_positions_are_refused():
    """Positions with masked entries, or with uneven rows, are refused."""
    mesh = meshes.octahedron()
    refiner = kahler(mesh)
    expected = refiner.refine(mesh.vertices).positions.copy()
    nothing_hidden = np.ma.masked_array(mesh.vertices, mask=False)
    assert (refiner.refine(nothing_hidden).positions == expected).all()
    nothing_hidden[4, 1] = np.ma.masked
    with pytest.raises(ValueError, match=r"positions must be .* masked entries; fill them"):
        refiner.refine(nothing_hidden)
    with pytest.raises(ValueError, match=r"positions must be .* is not an array"):
        refiner.refine([[0.0, 0.0], [1.0]])


@pytest.mark.parametrize("copied", [pickle.dumps, copy.deepcopy])
def test_refiners_stay_where_they_are(copied):
    """Copies and pickles of a refiner are refused.

    A copy would share buffers with the original, or have invalid pointers in another process.
    """
    mesh = meshes.octahedron()
    refiner = kahler(mesh)
    with pytest.raises(TypeError, match=r"make one there with refine\.create"):
        copied(refiner)


@pytest.mark.parametrize("number", [np.nan, np.inf, -1e15, 1e39])
@pytest.mark.parametrize("name", ["none", "kahler", "loop"])
def test_positions_that_are_no_numbers(name, number):
    """Positions that overflow in single precision are refused; the refiner's state is unchanged."""
    mesh = meshes.octahedron()
    refiner = refine.create(name, mesh.faces, mesh.vertices)
    deformed = mesh.vertices * [1.0, 1.0, 4.0]
    expected = refiner.refine(deformed).positions.copy()
    broken = mesh.vertices.copy()
    broken[3, 1] = number
    with pytest.raises(ValueError, match=r"finite and below 1e\+15, but vertex 3 .*\(1 such"):
        refiner.refine(broken)
    np.testing.assert_array_equal(refiner.refine(deformed).positions, expected)


@pytest.mark.parametrize("scheme", ["loop", "cubic", "detail"])
def test_anything_below_the_limit_is_finite(scheme):
    """Positions as large as the limit give finite numbers, so that no later stage gets NaN."""
    mesh = meshes.double_cone(60)
    refiner = kahler(mesh, scheme=scheme_of(scheme, mesh.vertices, mesh.faces))
    blown = np.random.default_rng(5).uniform(-0.99e15, 0.99e15, mesh.vertices.shape)
    refined = refiner.refine(blown)
    assert np.isfinite(refined.positions).all()
    assert np.isfinite(refined.normals).all()
