"""Random meshes with random options, judged only by corners and sub-edges.

Other tests vary one option at a time. These tests vary all options together, in any numeric type
and memory order. They judge the result differently from `refine.check`: they follow the border of
each triangle's pieces, and compare the bytes of all triangles along each edge.
"""

from collections import Counter, defaultdict

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from risorius import refine
from risorius.geometry.sides import sides_of
from tests import meshes
from tests.refine.cases import places_in_source, soups
from tests.refine.plain_twin import is_proper

DOUBLE_CONES = st.builds(meshes.double_cone, st.integers(3, 60))
IRREGULAR_MESHES = st.builds(
    meshes.irregular,
    st.integers(0, 99),
    columns=st.just(4),
    rows=st.just(3),
    holes=st.integers(0, 2),
)
SMALL_MESHES = st.sampled_from([make() for make in meshes.NAMED_MESHES.values()])
MESHES = st.one_of(
    soups(),
    *(
        kind.map(lambda mesh: (mesh.vertices, mesh.faces))
        for kind in (DOUBLE_CONES, IRREGULAR_MESHES, SMALL_MESHES)
    ),
)
CRITERIA = ("normal", "rest", "silhouette", "displacement", "normal+rest")
INDEX_TYPES = ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", ">i4")


@st.composite
def options(draw):
    """A random valid combination of options."""
    scheme = draw(st.sampled_from(["loop", "cubic", "detail"]))
    blend = draw(st.sampled_from([None, False, True]))
    allowed = [name for name in CRITERIA if name != "displacement" or scheme != "loop"]
    return {
        "scheme": scheme,
        "criterion": draw(st.sampled_from(allowed)),
        "blend": blend,
        "coherent": blend is not True and draw(st.booleans()),
    }


def in_other_order(array, order):
    """The same numbers, read-only, in another memory order."""
    if order == "fortran":
        array = np.asfortranarray(array)
    elif order == "reversed":
        array = array[::-1].copy()[::-1]
    elif order == "every other":
        array = np.repeat(array, 2, axis=0)[::2]
    view = array.view()
    view.flags.writeable = False
    return view


def borders(mesh, face, pieces, names):
    """Output rows along the three edges of an input triangle, from the border of its pieces."""
    sides = Counter(map(tuple, sides_of(pieces).tolist()))
    assert max(sides.values()) == 1
    border = [(a, b) for a, b in sides if (b, a) not in sides]
    following = dict(border)
    assert len(following) == len(border)
    (start,) = [row for row in following if names[row] == face[0]]
    loop = [start]
    while following[loop[-1]] != start:
        loop.append(following[loop[-1]])
        assert len(loop) <= 12
    assert len(loop) == len(following)
    names_in_loop = [names[row] for row in loop]
    places = [names_in_loop.index(corner) for corner in face]
    assert places == sorted(places)
    loop.append(start)
    ends = [*places[1:], len(loop) - 1]
    return [loop[begin : end + 1] for begin, end in zip(places, ends, strict=True)]


def assert_no_crack(refiner, mesh, faces):
    """Check that all triangles at an input edge have the same bytes along it."""
    origins = refiner.origins()
    is_vertex = origins.weights.max(axis=1) == 1.0
    vertex = origins.vertices[np.arange(len(is_vertex)), origins.weights.argmax(axis=1)]
    names = np.where(is_vertex, vertex, -1)
    shown = np.concatenate([mesh.positions, mesh.normals], axis=1)
    seen = defaultdict(set)
    counts = {}
    for number, face in enumerate(faces.tolist()):
        pieces = mesh.triangles[mesh.source == number].astype(np.int64)
        if len(set(face)) < 3:
            assert [names[pieces[0]].tolist()] == [face]
            continue
        for i, rows in enumerate(borders(mesh, face, pieces, names)):
            a = face[i]
            b = face[(i + 1) % 3]
            along = rows if a < b else rows[::-1]
            seen[min(a, b), max(a, b)].add(shown[along].tobytes())
            counts[min(a, b), max(a, b)] = len(rows) - 1
    assert all(len(different) == 1 for different in seen.values())
    splits = zip(refiner.edges.tolist(), refiner.splits.tolist(), strict=True)
    assert {(min(e), max(e)): 2**split for e, split in splits} == counts


@given(
    mesh=MESHES,
    chosen=options(),
    seed=st.integers(0, 2**16),
    precision=st.sampled_from(["f2", "f4", "f8", ">f4", ">f8"]),
    index=st.sampled_from(INDEX_TYPES),
    order=st.sampled_from(["c", "fortran", "reversed", "every other"]),
    textured=st.booleans(),
)
def test_anything_goes(mesh, chosen, seed, precision, index, order, textured):
    """Three frames of any mesh with any options are valid, have no cracks, and change no input."""
    generator = np.random.default_rng(seed)
    rest = in_other_order(mesh[0].astype(precision), order)
    faces = in_other_order(mesh[1].astype(index), order)
    corner_rows = generator.integers(4, size=mesh[1].shape)
    corner_values = generator.random((4, 2))
    if chosen["scheme"] == "detail":
        ball = meshes.octahedron()
        chosen = {**chosen, "scheme": refine.DetailScheme((ball.vertices + 0.1, ball.faces))}
    if textured:
        chosen = {**chosen, "uv": corner_values, "face_uv": corner_rows}
        chosen["attributes"] = {"weight": generator.random((len(rest), 3))}
    refiner = refine.create("kahler", faces, rest, **chosen)
    view = refine.View(generator.uniform(-5.0, 5.0, 3))
    for amplitude in (0.0, 0.5, 0.25):
        deformed = meshes.wrinkled(meshes.Mesh(*mesh), seed, amplitude).astype(precision)
        frame = in_other_order(deformed, order)
        refined = refiner.refine(frame, view=view)
        assert frame.tobytes() == deformed.tobytes()
        refine.check(refiner, refined, frame)
        assert_no_crack(refiner, refined, mesh[1])
        if textured:
            assert refined.uv is not None
            assert_linear(refiner, refined, mesh[1], corner_values[corner_rows])
    assert rest.tobytes() == mesh[0].astype(precision).tobytes()


def assert_linear(refiner, mesh, faces, corner_values):
    """Check that texture coordinates are linear in each input triangle.

    `corner_values`: (F, 3, 2).
    """
    origins = refiner.origins()
    is_proper_face = np.array([is_proper(face) for face in faces.tolist()])
    proper = is_proper_face[mesh.source]
    triangles = mesh.triangles[proper]
    source = mesh.source[proper]
    places = places_in_source(origins, triangles, faces[source])
    expected = np.einsum("tci,tiu->tcu", places, corner_values[source])
    np.testing.assert_allclose(mesh.uv[triangles], expected, rtol=0, atol=1e-5)
