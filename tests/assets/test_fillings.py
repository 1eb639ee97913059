"""Masks with mouth and eyes closed by triangles: the triangles are removed, all else stays."""

import json
from dataclasses import replace

import numpy as np
import pytest

from risorius import sim
from risorius.assets import AssetError
from risorius.assets.fitting import fit_head
from risorius.assets.fitting.fillings import filling_of
from risorius.assets.meshes import read_mesh
from tests.sim.poses import advance

from ..heads import SHIFT_VECTOR, TURN_MATRIX, UserHead, closed, filled, masked, nearly_shut

FILLING_TRIANGLES = 62  # triangles of `masked` across its mouth and eyes, the last of its list


@pytest.fixture(scope="module")
def mask() -> UserHead:
    """A mask with closed openings [mm]."""
    return masked()


def test_only_the_filling_is_left_out(mask):
    """Exactly the filling triangles are found, in any unit and place.

    With landmarks half a millimetre off, corners of the filling may stay.
    """
    last = np.arange(len(mask.mesh.faces))[-FILLING_TRIANGLES:]
    turned = replace(mask.mesh, vertices=0.001 * mask.mesh.vertices @ TURN_MATRIX.T + SHIFT_VECTOR)
    points = turned.vertices[mask.landmarks]
    off = np.random.default_rng(3).normal(0.0, 0.0003, points.shape)
    found = filling_of(turned, mask.landmarks, points)
    assert np.array_equal(np.sort(found.triangles), last)
    roughly = filling_of(turned, mask.landmarks, points + off)
    assert len(np.intersect1d(roughly.triangles, last)) > FILLING_TRIANGLES - 10
    assert len(np.setdiff1d(roughly.triangles, last)) < 3
    assert found.in_words == (
        "its mouth, right eye and left eye are filled by 62 triangles, which are left out; "
        "an avatar has them"
    )


def test_a_mask_is_opened_and_moves(mask, tmp_path):
    """A line reports the removed triangles; lips part, lids shut, vertices keep their numbers."""
    head = fit_head(*mask.write(tmp_path))
    assert any("filled by 62 triangles" in note for note in head.notes)
    assert len(head.faces) == len(mask.mesh.faces) - FILLING_TRIANGLES
    assert np.array_equal(head.file_vertices[head.landmarks], mask.landmarks)
    simulation = sim.create(head)
    simulation.controls.set("jawOpen", 1.0)
    simulation.controls.set("eyeBlinkLeft", 1.0)
    advance(simulation, 60)
    moved = simulation.positions - head.vertices
    upper, lower = head.landmarks[[62, 66]]
    assert moved[upper, 1] - moved[lower, 1] > 15.0
    lids = head.landmarks[[43, 44, 46, 47]]
    assert moved[lids[:2], 1].mean() < moved[lids[2:], 1].mean() - 3.0


def test_a_picture_stays_without_the_triangles(mask, tmp_path):
    """Triangles after the removed ones keep their texture coordinates and picture."""
    path, _ = mask.write(tmp_path)
    faces = mask.mesh.faces[::-1] + 1
    uv = np.round(mask.mesh.vertices[:, :2] / 400.0 + 0.5, 6)
    lines = ["mtllib a.mtl", "usemtl a"]
    lines += [f"v {x} {y} {z}" for x, y, z in mask.mesh.vertices]
    lines += [f"vt {u} {v}" for u, v in uv]
    lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in faces]
    path.write_text("\n".join(lines))
    mesh = read_mesh(path)
    opened = mesh.without(np.arange(FILLING_TRIANGLES))
    assert np.array_equal(opened.faces + 1, faces[FILLING_TRIANGLES:])
    assert opened.texture is None
    (tmp_path / "a.mtl").write_text("newmtl a\nmap_Kd a.png\n")
    opened = read_mesh(path).without(np.arange(FILLING_TRIANGLES))
    assert np.allclose(opened.texture.uv[opened.texture.face_uv], uv[faces[FILLING_TRIANGLES:] - 1])
    assert len(opened.texture.picture) == len(opened.faces)


def test_an_eye_that_is_part_of_the_skin_is_opened(mask, tmp_path):
    """In a scan, the front of an eyeball is skin between the lids; it is left out."""
    landmarks = mask.landmarks
    opened = mask.mesh.without(np.arange(len(mask.mesh.faces))[-FILLING_TRIANGLES:])
    covered = closed(filled(opened, landmarks[60:68]), landmarks[42:48])
    bulged = covered.vertices + 0.0
    bulged[-1, 2] += 3.0
    covered = replace(covered, vertices=bulged)
    found = filling_of(covered, landmarks, covered.vertices[landmarks])
    assert found.openings == ("mouth", "left eye")
    fan = np.flatnonzero((covered.faces == len(covered.vertices) - 1).any(axis=1))
    assert np.isin(fan, found.triangles).all()
    head = fit_head(*UserHead(covered, landmarks).write(tmp_path))
    simulation = sim.create(head)
    simulation.controls.set("eyeBlinkLeft", 1.0)
    advance(simulation, 60)
    upper, lower = simulation.positions[head.landmarks[[[43, 44], [47, 46]]]]
    assert np.abs(upper - lower)[:, 1].max() < 2.0


def test_skin_over_a_narrow_eye_is_no_filling(mask, tmp_path):
    """Skin over lids that are nearly shut is refused by name of the eye."""
    landmarks = mask.landmarks
    opened = mask.mesh.without(np.arange(len(mask.mesh.faces))[-FILLING_TRIANGLES:])
    eye = landmarks[42:48]
    covered = closed(filled(nearly_shut(opened, eye), landmarks[60:68]), eye)
    path, marks = UserHead(covered, landmarks).write(tmp_path)
    assert json.loads(marks.read_text())
    with pytest.raises(AssetError, match="the left eye has no opening"):
        fit_head(path, marks)
