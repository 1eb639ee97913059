"""Wrinkles that are shape: no crack, bounded, of the drawn mesh alone, and seen by every pass."""

from collections import Counter
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from risorius import assets, refine, render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.refining.presets import STATIC, Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.refining.wrinkling import Compression, Relief, on_rows, relief_of
from risorius.app.scenes import FaceScene, PlaneScene
from risorius.assets.model import HIGHEST_FOLD

JOY = Refinement()
SIDE = 6  # of the sheet, in cells of 8 mm


@pytest.fixture(scope="module")
def joy() -> FaceScene:
    """A face that smiles."""
    scene = FaceScene()
    scene.pose({"joy": 1.0})
    scene.step(1.2)
    return scene


def sheet(seed: int) -> Any:
    """A flat sheet with a random relief, whose right half has other texture coordinates."""
    numbers = np.arange((SIDE + 1) ** 2).reshape(SIDE + 1, SIDE + 1)
    a, b, c, d = (each.ravel() for each in _cells(numbers))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    rows, columns = np.divmod(numbers.ravel(), SIDE + 1)
    uv = np.column_stack([columns, rows]) / SIDE
    is_right = columns[faces].max(axis=1) > SIDE // 2
    random = np.random.default_rng(seed)
    across = np.zeros((len(uv), 2, 3), np.float32)
    across[:, :, 0] = 1.0
    coarse = random.integers(-63, 64, (8, 8, 2))
    relief = np.kron(coarse, np.ones((4, 4, 1), np.int64)).astype(np.int8)
    map_ = np.zeros((4, 4, 4), np.uint8)
    return SimpleNamespace(
        name="face",
        faces=faces.astype(np.int32),
        rest_positions=8.0 * np.column_stack([columns, rows, np.zeros_like(rows)]).astype(float),
        uv=np.concatenate([0.5 * uv, 0.5 * uv + 0.37]).astype(np.float32),
        face_uv=(faces + len(uv) * is_right[:, None]).astype(np.int32),
        wrinkles=assets.Wrinkles(map_, 1.0, across, relief),
    )


def _cells(numbers: npt.NDArray[np.int64]) -> tuple[npt.NDArray[np.int64], ...]:
    return numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]


def folded(
    scene: Any, refinement: Refinement, positions: npt.NDArray[np.float64], strength: float = 1.0
) -> tuple[npt.NDArray[np.float32], refine.RefinedMesh]:
    """The mesh with folds, and where its vertices were without."""
    refiner = refiner_for(scene, refinement)
    mesh = refiner.refine(positions)
    smooth = mesh.positions.copy()
    rows = on_rows(Compression(scene).amounts(positions), refiner)
    relief = relief_of(scene, refinement)
    if rows is not None and relief is not None:
        relief.move(mesh, strength * rows)
    return smooth, mesh


def rims(positions: npt.NDArray[np.float32], triangles: npt.NDArray[np.uint32]) -> list[Any]:
    """Where the edges lie that have a triangle on one side alone, once equal places are one."""
    _, place = np.unique(positions, axis=0, return_inverse=True)
    corners = place.ravel()[triangles]
    sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1), axis=-1)
    counts = Counter(map(tuple, sides.reshape(-1, 2).tolist()))
    ends = {number: row for number, row in zip(place.ravel(), positions, strict=True)}
    return [(ends[a], ends[b]) for (a, b), count in counts.items() if count == 1]


@given(
    seed=st.integers(0, 2**32 - 1),
    scheme=st.sampled_from(["loop", "cubic"]),
    squeeze=st.floats(0.6, 0.99),
    bend=st.floats(0.0, 0.02),
    strength=st.floats(0.1, 1.0),
)
def test_folds_never_crack(
    seed: int, scheme: str, squeeze: float, bend: float, strength: float
) -> None:
    """At seams, and between split edges and others: whatever was closed is, but for the rim."""
    scene = sheet(seed)
    random = np.random.default_rng(seed)
    positions = scene.rest_positions * [squeeze, 1.0, 1.0]
    positions[:, 2] += bend * (positions[:, 0] - 20.0) ** 2 + random.normal(
        0.0, 0.3, len(positions)
    )
    by = Refinement(options={"scheme": scheme, "criterion": "normal"})
    smooth, mesh = folded(scene, by, positions, strength)
    before, after = rims(smooth, mesh.triangles), rims(mesh.positions, mesh.triangles)
    assert len(before) == len(after)
    moved = np.linalg.norm(mesh.positions - smooth, axis=1)
    assert moved.max() <= strength * HIGHEST_FOLD + 1e-5


def test_the_sheet_has_folds_to_crack() -> None:
    """What the property is about is there: skin that is moved, and a seam beside it."""
    scene = sheet(3)
    smooth, mesh = folded(scene, JOY, scene.rest_positions * [0.7, 1.0, 1.0])
    moved = np.linalg.norm(mesh.positions - smooth, axis=1)
    assert moved.max() > 0.2 and len(np.unique(smooth, axis=0)) < len(smooth)
    # Moved each by its own side's relief, the seam would open.
    wild = smooth + Relief(scene.wrinkles).heights(mesh.uv)[:, :1] * mesh.normals
    assert len(rims(wild, mesh.triangles)) > len(rims(smooth, mesh.triangles))


def test_at_rest_and_in_the_papers_look_there_are_none(joy: FaceScene) -> None:
    """The paper's rule alone decides in its look; the mesh as it is stays as it is."""
    for refinement in (Refinement("paper"), Refinement(refiner=STATIC)):
        assert relief_of(joy, refinement) is None
    assert relief_of(PlaneScene(), Refinement()) is None
    plain = refine.create(
        "kahler", joy.faces, joy.rest_positions, scheme="cubic", criterion="displacement+rest"
    )
    bound = refiner_for(joy, Refinement())
    count = len(bound.refine(joy.rest_positions).triangles)
    assert count == len(plain.refine(joy.rest_positions).triangles)
    more = len(bound.refine(joy.positions).triangles)
    assert len(plain.refine(joy.positions).triangles) < more < 1.15 * count


def test_depths_shadows_and_normals_show_them(joy: FaceScene) -> None:
    """Each pass of the picture has the fold beside the smile, and none of them without wrinkles."""
    options = CaptureOptions(size=(320, 240), camera="20,0,2.4", passes=("depth", "normal"))
    found = []
    with Capture(joy, options) as capture:
        for strength in (0.0, 1.0):
            capture.options = replace(options, style=render.Style(bumps=strength))
            frame = capture.draw_frame()
            assert frame.known is not None
            shadow = capture.pipeline.renderer._shadow
            assert shadow is not None and isinstance(shadow._depth, moderngl.Texture)
            depths = np.frombuffer(shadow._depth.read(), np.uint32).astype(np.float64)
            found.append((frame.known.images["depth"], frame.known.images["normal"], depths))
    smooth, wrinkled = found
    is_skin = (smooth[0] > 0.0) & (wrinkled[0] > 0.0)
    nearer = (smooth[0] - wrinkled[0])[is_skin]
    assert (nearer > 0.4).sum() > 100 and (nearer < -0.3).sum() > 100  # cheek, and crease
    turned = (smooth[1] * wrinkled[1]).sum(axis=2)[is_skin]
    assert (turned < 0.97).sum() > 100 and np.median(turned) > 0.9999
    assert (smooth[2] != wrinkled[2]).sum() > 30


def test_carved_normals_are_those_of_the_folds(joy: FaceScene) -> None:
    """For other programs: unit normals, nearer than the smooth ones to the moved triangles'."""
    refiner = refiner_for(joy, Refinement())
    mesh = refiner.refine(joy.positions)
    smooth = mesh.normals.copy()
    rows = on_rows(Compression(joy).amounts(joy.positions), refiner)
    assert rows is not None
    Relief(joy.wrinkles).carve(mesh, rows)  # type: ignore[arg-type]
    corners = mesh.positions[mesh.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wrinkled = rows[mesh.triangles].max(axis=(1, 2)) > 0.5
    off = [
        1.0
        - (flat * each[mesh.triangles].sum(axis=1)).sum(axis=1)[wrinkled].sum()
        / (np.linalg.norm(flat, axis=1) * 3.0)[wrinkled].sum()
        for each in (smooth, mesh.normals)
    ]
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-5)
    assert off[1] < off[0]
