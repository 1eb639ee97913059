"""Helpers for tests of refine/: forced splits, names of output points, generated meshes."""

from typing import Any

import numpy as np
import numpy.typing as npt
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from risorius import refine
from risorius.geometry.arrays import Floats32, Floats64, Integers32, Unsigned8
from risorius.refine.beyond.blending import RAMP_WIDTH
from tests import meshes
from tests.refine import plain_twin

SOME_PLACES = np.random.default_rng(6).dirichlet([1, 1, 1], 12)
"""Barycentric coordinates of places in a triangle, shape (12, 3)."""


def configuration_of(splits: tuple[int, int, int]) -> int:
    """The number of the table entry for 0, 1 or 2 splits on each of the three edges."""
    return splits[0] + 3 * splits[1] + 9 * splits[2]


def kahler(mesh: meshes.Mesh, **options: Any) -> refine.Kahler:
    """The paper's refiner of a mesh, with its texture coordinates if it has any."""
    bound = refine.create("kahler", mesh.faces, mesh.vertices, mesh.uv, mesh.face_uv, **options)
    assert isinstance(bound, refine.Kahler)
    return bound


def edge_count_of(mesh: meshes.Mesh) -> int:
    """Number of edges of a mesh."""
    return len(refine.connect(mesh.faces, len(mesh.vertices)).edges)


def scheme_of(
    name: str, finer_positions: npt.ArrayLike, finer_faces: npt.ArrayLike
) -> str | refine.Scheme:
    """The scheme with this name; only `detail` gets the finer mesh."""
    return refine.DetailScheme((finer_positions, finer_faces)) if name == "detail" else name


def sound_frame(refiner: refine.Refiner, positions: Floats64) -> refine.RefinedMesh:
    """Refine a frame, check that it is sound, and return it."""
    refined = refiner.refine(positions)
    refine.check(refiner, refined, positions)
    return refined


class GivenMetric(refine.Criterion):
    """A criterion that measures the given values."""

    def __init__(self, metric: npt.ArrayLike) -> None:
        self.metric = np.asarray(metric, dtype=np.float32)

    def measure(self, positions: object, normals: object, metric: Floats32) -> None:
        """Write the metrics."""
        metric[:] = self.metric

    def geomorph(self, edges: Integers32) -> plain_twin.GeomorphWeights:
        """Geomorph weights that blending computes from the metrics, in the simple twin's form."""
        once = np.clip(self.metric / RAMP_WIDTH, 0, 1)
        twice = np.clip((self.metric - 1) / RAMP_WIDTH, 0, 1)
        names = [plain_twin.edge_name(a, b) for a, b in edges]
        return {n: (float(p), float(q)) for n, p, q in zip(names, once, twice, strict=True)}


class Forced(refine.Criterion):
    """A criterion that splits given edges, for any positions."""

    def __init__(self, splits: npt.ArrayLike) -> None:
        self.wanted = np.asarray(splits, dtype=np.uint8)

    def mark(self, positions: object, normals: object, splits: Unsigned8) -> None:
        """Write the wanted splits."""
        splits[:] = self.wanted

    def measure(self, positions: object, normals: object, metric: Floats32) -> None:
        """Write metrics at which all points of these splits have grown."""
        metric[:] = np.where(self.wanted > 0, self.wanted, -np.inf)


def point_names(origins: refine.Origins) -> list[plain_twin.Name]:
    """Names of the last frame's vertices, in the form of the simple twin."""
    names: list[plain_twin.Name] = []
    for vertices, weights in zip(origins.vertices, origins.weights, strict=True):
        quarters = (4.0 * weights).tolist()
        shares = zip(vertices.tolist(), quarters, strict=True)
        parts = sorted((vertex, share) for vertex, share in shares if share)
        if len(parts) == 3:
            names.append(("centre", *(v for v, _ in parts)))
        elif len(parts) == 1:
            names.append(("vertex", parts[0][0]))
        else:
            (low, _), (high, from_low) = parts
            names.append(("edge", low, high, int(from_low)))
    return names


def assert_equals_twin(
    refiner: refine.Refiner,
    mesh: refine.RefinedMesh,
    twin: plain_twin.Twin,
    *,
    normals_cancel: bool = False,
    tolerance: tuple[float, float] = (5e-7, 8e-6),
) -> None:
    """Check that every point, normal and triangle equals the simple twin's, to float32.

    `normals_cancel`: skip the normals, because opposite triangles at a vertex leave only rounding
    errors; `tolerance`: for positions and for normals.
    """
    names = point_names(refiner.origins())
    assert set(names) == set(twin.positions)
    expected = np.array([twin.positions[name] for name in names])
    scale = max(1.0, float(abs(expected).max(initial=0.0)))
    assert_allclose(mesh.positions, expected, rtol=0, atol=tolerance[0] * scale)
    if not normals_cancel:
        normals = np.array([twin.normals[name] for name in names])
        assert_allclose(mesh.normals, normals, rtol=0, atol=tolerance[1])
    triangles = [
        (int(source), plain_twin.starting_at_least([names[v] for v in corners]))
        for source, corners in zip(mesh.source, mesh.triangles, strict=True)
    ]
    assert sorted(map(str, triangles)) == sorted(map(str, twin.triangles))


def as_lists(
    positions: Floats64, faces: npt.NDArray[np.integer]
) -> tuple[list[plain_twin.Vector], list[tuple[int, int, int]]]:
    """Arrays in the form of the simple twin."""
    points = [(float(x), float(y), float(z)) for x, y, z in positions]
    return points, [(int(a), int(b), int(c)) for a, b, c in faces]


def places_in_source(
    origins: refine.Origins, triangles: npt.NDArray[Any], faces: npt.NDArray[Any]
) -> Floats32:
    """Barycentric places (M, 3, 3) of subtriangle corners in their input triangles (M, 3)."""
    is_corner = origins.vertices[triangles][..., None] == faces[:, None, None, :]
    return np.asarray((origins.weights[triangles][..., None] * is_corner).sum(axis=2))


def surface_at(
    refiner: refine.Refiner,
    refined: refine.RefinedMesh,
    faces: Integers32,
    places: Floats64,
) -> Floats64:
    """Positions and unit normals at places, shape (P, 3), of every input triangle, (F, P, 6)."""
    origins = refiner.origins()
    result = np.full((len(faces), len(places), 6), np.nan)
    rows = np.concatenate([refined.positions, refined.normals], axis=1).astype(np.float64)
    is_proper = np.array([plain_twin.is_proper(face) for face in faces.tolist()])
    is_shown = is_proper[refined.source]
    corners = refined.triangles[is_shown]
    source = refined.source[is_shown]
    local = places_in_source(origins, corners, faces[source])
    shares = places @ np.linalg.inv(local.astype(np.float64))
    triangle, place = np.nonzero((shares > -1e-9).all(axis=2))
    values = np.einsum("nk,nki->ni", shares[triangle, place], rows[corners[triangle]])
    result[source[triangle], place] = values
    lengths = np.linalg.norm(result[..., 3:], axis=2, keepdims=True)
    result[..., 3:] /= lengths
    return result[is_proper]


@st.composite
def soups(draw: st.DrawFn) -> tuple[Floats64, Integers32]:
    """Random triangles over a few vertices, including borders, fins, flips, doubles and debris."""
    vertex_count = draw(st.integers(3, 8))
    index = st.integers(0, vertex_count - 1)
    faces = draw(st.lists(st.tuples(index, index, index), min_size=1, max_size=12))
    seed = draw(st.integers(0, 2**16))
    positions = np.random.default_rng(seed).uniform(-1.0, 1.0, (vertex_count, 3))
    return positions, np.array(faces, dtype=np.int32)
