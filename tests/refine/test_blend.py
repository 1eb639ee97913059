"""Nothing pops: the refined surface is a continuous function of the positions."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import refine
from tests import meshes
from tests.refine.cases import Forced, Needed

SCHEMES = ("loop", "butterfly", "cubic", "detail")
BOUND = 12.0
"""No point of the surface moves more than this many times the largest motion of the input.

Largest seen: 3.9 for curved edges, 5.0 for detail, 4.7 for the paper's rules; a quarter of the thresholds' distance, over
which a point grows, is a small turn. Without blending 26 to 65, more the smaller the steps are."""
STEPS = 400


def surface_at(
    refiner: refine.Refiner,
    refined: refine.RefinedMesh,
    faces: npt.NDArray[np.int32],
    places: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """Positions and unit normals at places, shape (P, 3), of every input triangle, (F, P, 6)."""
    origins = refiner.origins()
    result = np.full((len(faces), len(places), 6), np.nan)
    rows = np.concatenate([refined.positions, refined.normals], axis=1).astype(np.float64)
    corners, source = refined.triangles, refined.source
    at_corner = origins.vertices[corners][..., None] == faces[source][:, None, None, :]
    local = (origins.weights[corners][..., None] * at_corner).sum(axis=2).astype(np.float64)
    shares = places @ np.linalg.inv(local)
    triangle, place = np.nonzero((shares > -1e-9).all(axis=2))
    values = np.einsum("nk,nki->ni", shares[triangle, place], rows[corners[triangle]])
    result[source[triangle], place] = values
    lengths = np.linalg.norm(result[..., 3:], axis=2, keepdims=True)
    result[..., 3:] /= lengths
    return result


def jumps(
    scheme: str, blend: bool, criterion: object, mesh: meshes.Mesh | None = None
) -> tuple[float, float]:
    """Largest motion of the surface per motion of the input, and turn of a normal [rad] per step.

    A sheet is bent from flat to strongly wrinkled and on, in small steps, so that edges go through
    both thresholds in both directions, one after the other.
    """
    mesh = mesh or meshes.irregular(4, 4, 3, 0)
    wave = meshes.wrinkled(mesh, 5, 0.5) - mesh.vertices
    detail = {"detail": (mesh.vertices + 0.02, mesh.faces)} if scheme == "detail" else {}
    refiner = refine.create(
        "kahler",
        mesh.faces,
        mesh.vertices,
        uv=mesh.uv,
        face_uv=mesh.face_uv,
        scheme=scheme,
        blend=blend,
        criterion=criterion,
        **detail,
    )
    places = np.random.default_rng(6).dirichlet([1, 1, 1], 12)
    before, most, turn = None, 0.0, 0.0
    positions_before = mesh.vertices
    seen = set()
    for step in range(1, STEPS):
        positions = mesh.vertices + np.sin(1.6 * step / STEPS * np.pi) * wave
        now = surface_at(refiner, refiner.refine(positions), mesh.faces, places)
        seen.add(refiner.splits.tobytes())
        moved = np.linalg.norm(positions - positions_before, axis=1).max()
        if before is not None and moved > 1e-6:  # the motion turns back once
            most = max(most, float(np.linalg.norm((now - before)[..., :3], axis=2).max() / moved))
            turn = max(turn, float(np.linalg.norm((now - before)[..., 3:], axis=2).max()))
        before, positions_before = now, positions
    assert len(seen) > 20
    return most, turn


@pytest.mark.parametrize("scheme", SCHEMES)
def test_nothing_pops(scheme: str) -> None:
    """With blending every point of the surface moves at most in proportion to the input."""
    most, turn = jumps(scheme, True, "normal")
    assert most < BOUND
    assert turn < 0.3  # smaller steps turn it less: 0.08 with 1600 steps


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", ["seam", "valence 20"])
def test_nothing_pops_at_seams_and_tips(name: str, scheme: str) -> None:
    """Nor on a small tube with a seam, nor at a tip, where normals turn faster than elsewhere."""
    mesh = meshes.tube(6, 3) if name == "seam" else meshes.double_cone(20)
    blended = jumps(scheme, True, "normal", mesh)[0]
    assert blended < 2 * BOUND
    assert blended < 0.7 * jumps(scheme, False, "normal", mesh)[0]


@pytest.mark.parametrize("scheme", ["cubic", "detail"])
@pytest.mark.parametrize("criterion", ["curvature", "bulge", ["normal", "curvature"]])
def test_nothing_pops_by_other_criteria(criterion: object, scheme: str) -> None:
    """The same for the other criteria and their maximum."""
    assert jumps(scheme, True, criterion)[0] < BOUND


def test_without_blending_it_pops() -> None:
    """The measure is able to see a pop: the paper's rules have some."""
    assert jumps("loop", False, "normal")[0] > 2 * BOUND


@pytest.mark.parametrize("scheme", SCHEMES)
def test_begins_at_the_unrefined_surface(scheme: str) -> None:
    """Edges of hardly any need give the surface of the mesh itself; grown ones the full scheme."""
    mesh = meshes.irregular(7, 5, 4, 0)
    deformed = meshes.wrinkled(mesh, 8)
    edge_count = len(refine.connect(mesh.faces, len(mesh.vertices)).edges)
    detail = {"detail": (mesh.vertices + 0.02, mesh.faces)} if scheme == "detail" else {}
    places = np.random.default_rng(9).dirichlet([1, 1, 1], 8)

    def surface(need: float) -> npt.NDArray[np.float64]:
        refiner = refine.create(
            "kahler", mesh.faces, mesh.vertices, scheme=scheme, blend=True,
            criterion=Needed(np.full(edge_count, need)), **detail,
        )  # fmt: skip
        return surface_at(refiner, refiner.refine(deformed), mesh.faces, places)[..., :3]

    np.testing.assert_allclose(surface(1e-6), surface(-1.0), rtol=0, atol=1e-5)
    np.testing.assert_allclose(surface(1.0 + 1e-6), surface(1.0 - 1e-6), rtol=0, atol=1e-5)
    assert abs(surface(0.5) - surface(-1.0)).max() > 0.01


def test_defaults() -> None:
    """Blending is on where it costs no faithfulness: not for the paper's scheme."""
    mesh = meshes.octahedron()
    for options, expected in (
        ({}, 10),
        ({"scheme": "cubic"}, 12),
        ({"scheme": "butterfly", "blend": False}, 10),
        ({"scheme": "cubic", "criterion": Forced(np.zeros(12))}, 10),
        ({"blend": True}, 12),
    ):
        refiner = refine.create("kahler", mesh.faces, mesh.vertices, **options)
        assert refiner.triangle_capacity == expected * 8


def test_needs_a_measure() -> None:
    """A criterion that only counts splits cannot be blended."""
    mesh = meshes.octahedron()
    with pytest.raises(ValueError, match="blend=True needs a criterion that measures, but Forced"):
        refine.create(
            "kahler", mesh.faces, mesh.vertices, blend=True, criterion=Forced(np.zeros(12))
        )
