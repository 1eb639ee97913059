"""Vertices that files double: at texture seams, and at touching lips."""

import json
from dataclasses import replace

import numpy as np
import pytest

from risorius import assets
from risorius.assets import AssetError, Mesh
from risorius.assets.fitting import FittedHead, fit, fit_head
from risorius.assets.model import Head
from tests.assets.gltf_files import GltfMaker
from tests.assets.test_gltf import material, png

# Landmarks in the middle of the inner lips.
UPPER_LIP_LANDMARKS = [61, 62, 63]
LOWER_LIP_LANDMARKS = [67, 66, 65]


@pytest.fixture(scope="module")
def plain(head: Head) -> FittedHead:
    """The built-in head, fitted to its own mesh."""
    return fit(Mesh(head.vertices, head.faces), head.landmarks)


def assert_same(found, plain):
    """Check that two heads have the same triangles at the same places."""
    assert found.faces.shape == plain.faces.shape
    assert len(found.vertices) == len(plain.vertices)
    assert np.abs(found.vertices[found.faces] - plain.vertices[plain.faces]).max() < 1e-2


def test_a_skin_that_is_cut_along_seams_hangs_together(head, plain):
    """A skin that is cut along its middle, as for a mirrored texture, becomes one piece."""
    is_left = head.vertices[head.faces][:, :, 0].mean(axis=1) > 0.0
    count = len(head.vertices)
    faces = head.faces + count * is_left[:, None].astype(np.int32)
    is_used = np.isin(head.landmarks, faces)
    landmarks = np.where(is_used, head.landmarks, head.landmarks + count)
    found = fit(Mesh(np.vstack([head.vertices] * 2), faces), landmarks.astype(np.int32))
    assert_same(found, plain)


def test_triangles_of_their_own_vertices_hang_together(head, plain, tmp_path):
    """A mesh whose triangles share no vertices, as some programs write, becomes one piece.

    Landmarks are given as points.
    """
    corners = head.vertices[head.faces].reshape(-1, 3)
    lines = [f"v {x} {y} {z}" for x, y, z in corners.tolist()]
    numbers = np.arange(1, len(corners) + 1).reshape(-1, 3)  # OBJ counts from 1
    lines += [f"f {a} {b} {c}" for a, b, c in numbers.tolist()]
    (tmp_path / "soup.obj").write_text("\n".join(lines))
    (tmp_path / "soup.json").write_text(json.dumps(head.vertices[head.landmarks].tolist()))
    assert_same(fit_head(tmp_path / "soup.obj", tmp_path / "soup.json"), plain)


@pytest.mark.parametrize(
    "way",
    [
        "bare",
        pytest.param("pictured", marks=pytest.mark.slow),
        pytest.param("moved apart", marks=pytest.mark.slow),
    ],
)
def test_lips_that_touch_exactly_are_two(head, tmp_path, way):
    """Lips that touch exactly are kept separate: with and without a picture, and with a shape."""
    upper, lower = (head.landmarks[lip] for lip in (UPPER_LIP_LANDMARKS, LOWER_LIP_LANDMARKS))
    vertices = head.vertices.copy()
    vertices[lower] = vertices[upper]
    maker = GltfMaker()
    more = {}
    apart = np.zeros_like(vertices)
    if way == "pictured":
        uv = vertices[:, :2] / 500 + 0.5
        more["attributes"] = {"TEXCOORD_0": maker.accessor(uv)}
        more["material"] = material(maker, {"index": maker.picture(png())})
    if way == "moved apart":
        apart[lower] = [0, -20, 0]
        more["targets"] = [{"POSITION": maker.accessor(apart)}]
    maker.shown({"mesh": maker.mesh(maker.primitive(vertices, head.faces, **more))})
    mesh = maker.write(tmp_path / "head.glb")
    marks = tmp_path / "head.json"
    marks.write_text(json.dumps(head.landmarks.tolist()))
    for file in (marks, None):  # also without landmarks: the head is known by its vertices
        found = fit_head(mesh, file)
        assert found.lip_cut is None
        assert len(found.vertices) == len(head.vertices)
        assert np.array_equal(found.file_vertices[found.landmarks], head.landmarks)


def test_lips_that_share_vertices_are_refused(head, tmp_path):
    """Lips that share vertices cannot part, so the head is refused."""
    number = np.arange(len(head.vertices))
    number[head.landmarks[LOWER_LIP_LANDMARKS]] = head.landmarks[UPPER_LIP_LANDMARKS]
    maker = GltfMaker()
    maker.shown({"mesh": maker.mesh(maker.primitive(head.vertices, number[head.faces]))})
    marks = tmp_path / "head.json"
    marks.write_text(json.dumps(number[head.landmarks].tolist()))
    with pytest.raises(AssetError, match="the mouth is shut"):
        fit_head(maker.write(tmp_path / "head.glb"), marks)


def test_pieces_that_are_left_away_may_be_painted_with_anything(head, tmp_path):
    """An unreadable picture of hair has no effect on the skin; eyes need no colours."""
    maker = GltfMaker()
    broken = material(maker, {"index": maker.picture(b"no picture")})
    own = material(maker, {"index": maker.picture(png())})
    uv = {"TEXCOORD_0": maker.accessor(head.vertices[:, :2] / 500 + 0.5)}
    hair = maker.primitive(
        [[0, 200, 0], [9, 200, 0], [0, 209, 0]],
        [0, 1, 2],
        attributes={"TEXCOORD_0": maker.accessor(np.zeros((3, 2)))},
        material=broken,
    )
    skin = maker.primitive(head.vertices, head.faces, attributes=uv, material=own)
    maker.shown({"mesh": maker.mesh(hair)}, {"mesh": maker.mesh(skin)})
    mesh = assets.read_mesh(maker.write(tmp_path / "head.glb"))
    found = fit(mesh, head.landmarks)
    assert found.albedo.shape == (4, 4, 3)
    assert found.albedo[0, 0].tolist() == [250, 10, 20]


def test_colours_of_the_skin_count_alone(head):
    """The skin keeps its picture if eyes or hair have no colours, or if only these have colours."""
    count = len(head.vertices)
    vertices = np.vstack([head.vertices, head.vertices[:3] + 500.0])
    faces = np.vstack([head.faces, [[count, count + 1, count + 2]]]).astype(np.int32)
    blue = np.tile(np.array([[10, 20, 250]], np.uint8), (len(vertices), 1))
    is_skin = np.arange(len(vertices)) < count
    mesh = Mesh(vertices, faces, colours=blue, has_colour=is_skin)

    def blue_share(mesh):
        """The share of blue in the picture of a fitted head."""
        picture = fit(mesh, head.landmarks).albedo.astype(int)
        return (abs(picture - blue[0]).max(axis=2) < 3).mean()

    assert blue_share(mesh) > 0.4
    assert blue_share(replace(mesh, has_colour=~is_skin)) < 0.01
