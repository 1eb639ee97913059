"""glTF files: every vertex at every frame of a clip, read by other readers."""

import functools
import io
import json
import re
import struct
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import trimesh
from numpy.linalg import norm

from risorius.app.export import gltf
from risorius.app.export.clip import Clip, record
from risorius.app.export.formats import ExportRequest, format_for, write
from risorius.app.export.morphs import decompose
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.rig.poses import rest_in
from risorius.app.rig.scene_meshes import _normal_map
from risorius.app.rig.surface import MovingSurface
from risorius.app.script.script_file import parse_script
from risorius.assets.fitting import fit_head
from risorius.assets.identities import person_called
from risorius.geometry.directions import unit_vectors
from risorius.geometry.gradients import TextureGradients
from risorius.geometry.normals import vertex_normals

from .command_line import positions_in_blender
from .glb_player import Player

TOLERANCE = 0.1e-3  # [m], as documented
SCRIPT = """
title = "All that moves"
[[pose]]
time = 0.0
tongue_out = 0.3
[[pose]]
time = 0.3
joy = 1.0
head_yaw = 1.0
head_pitch = -0.5
gaze_horizontal = 0.8
[[pose]]
time = 0.7
yawn = 1.0
tongue_out = 1.0
jaw_sideways = 0.5
head_yaw = -1.0
head_roll = 0.6
gaze_vertical = -0.7
"""
TAKE = """
duration = 1.5
[tracks]
jawOpen = [{ time = 0.0, value = 0.0 }, { time = 0.5, value = 0.6 }]
mouthSmileLeft = [{ time = 0.0, value = 0.0 }, { time = 0.5, value = 0.8 }]
"""


@pytest.fixture(scope="module")
def clip() -> Clip:
    """A face that moves all its parts."""
    return record(parse_script(SCRIPT, source="test"), None, 24.0, progress=False)


def written(clip, path):
    """Write the clip; return the printed remark."""
    return write(clip, path, format_for(path, None), ExportRequest())


@pytest.fixture(scope="module")
def glb(clip: Clip, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clip's file."""
    path = tmp_path_factory.mktemp("glb") / "face.glb"
    remark = written(clip, path)
    assert remark.startswith("52 named targets and ")
    assert re.search(
        r"at most 0\.(0\d|10) mm from the simulation \(\w+\), RMS of the skin 0\.0\d$", remark
    )
    return path


def farthest(player, clip, name):
    """The largest error of any vertex of a surface in any frame [m]."""
    surface = next(each for each in clip.surfaces if each.name == name)
    largest = 0.0
    for frame in range(clip.frame_count):
        off = player.positions(name, frame) - surface.at(frame) / 1000.0
        largest = max(largest, float(norm(off, axis=1).max()))
    return largest


def test_every_vertex_is_where_the_clip_has_it(clip, glb):
    """Skin, eyes, teeth and tongue are exact in every frame, with a turned head."""
    player = Player(glb)
    assert {surface.name for surface in clip.surfaces} <= set(player.numbers)
    assert np.array_equal(player.times, clip.times.astype(np.float32))
    frames = np.stack([clip.skin.at(k) for k in range(clip.frame_count)])
    moved = np.ptp(frames, axis=0)
    assert moved.max() > 50.0  # [mm]: a face without motion would fail
    for surface in clip.surfaces:
        assert farthest(player, clip, surface.name) < TOLERANCE, surface.name
        assert np.array_equal(
            player.values(player.primitive(surface.name).indices).reshape(-1, 3), surface.faces
        )


def test_normals_follow_the_motion(clip, glb):
    """Sums of morphed normals, as engines compute them, nearly equal the moved mesh's normals."""
    player = Player(glb)
    for frame in range(0, clip.frame_count, 4):
        shape = player.shape("skin", frame)
        normals = player.shape("skin", frame, "NORMAL")
        normals = unit_vectors(normals)
        expected = vertex_normals(shape, clip.skin.faces)
        angles = np.degrees(np.arccos(np.clip((normals * expected).sum(axis=1), -1.0, 1.0)))
        assert np.percentile(angles, 99) < 3.0


def test_the_mesh_at_rest_is_read_by_trimesh(clip, glb):
    """A reader without morph targets shows the neutral face in metres, with fitting parts."""
    scene = trimesh.load_scene(glb, process=False)
    assert len(scene.geometry) == len(clip.surfaces)
    skin = scene.geometry["skin"]
    assert np.abs(skin.vertices - clip.skin.rest / 1000.0).max() < 1e-6
    assert np.array_equal(skin.faces, clip.skin.faces)
    eye = next(surface for surface in clip.surfaces if surface.name == "eyeball_left")
    transform, geometry = scene.graph["eyeball_left"]
    placed = trimesh.transform_points(scene.geometry[geometry].vertices, transform)
    assert np.abs(placed - eye.rest / 1000.0).max() < 1e-6


def test_the_file_is_as_validators_want_it(glb):
    """Chunks, alignment, bounds and counts are valid; weights have the sum 1, normals length 1."""
    data = glb.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    text_length, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    assert text_length % 4 == 0
    parts = json.loads(data[20 : 20 + text_length])
    blob_length, kind = struct.unpack_from("<I4s", data, 20 + text_length)
    assert kind == b"BIN\0"
    assert blob_length % 4 == 0
    assert len(data) == 28 + text_length + blob_length
    assert parts["buffers"] == [{"byteLength": blob_length}]
    ends = 0
    for view in parts["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert ends <= view["byteOffset"] < ends + 4
        ends = view["byteOffset"] + view["byteLength"]
    assert blob_length - ends < 4
    player = Player(glb)
    positions = set()
    for mesh in parts["meshes"]:
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            added = primitive.get("targets", [])
            positions |= {attributes["POSITION"], *(each["POSITION"] for each in added)}
            numbers = [number for rows in (attributes, *added) for number in rows.values()]
            counts = {parts["accessors"][number]["count"] for number in numbers}
            assert len(counts) == 1
            indices = player.values(primitive["indices"])
            assert indices.max() == counts.pop() - 1 < 65535
            normals = player.values(attributes["NORMAL"])
            assert np.abs(norm(normals, axis=1) - 1.0).max() < 5e-4
            if "WEIGHTS_0" in attributes:
                shares = player.values(attributes["WEIGHTS_0"])
                joints = player.values(attributes["JOINTS_0"])
                assert np.abs(shares.sum(axis=1) - 1.0).max() < 1e-6
                assert shares.min() >= 0.0
                assert joints.max() < 2
                assert not joints[shares == 0.0].any()
    times = {sampler["input"] for sampler in parts["animations"][0]["samplers"]}
    for number in positions | times:
        accessor = parts["accessors"][number]
        values = player.values(number)
        assert np.array_equal(np.float32(accessor["min"]), np.atleast_1d(values.min(axis=0)))
        assert np.array_equal(np.float32(accessor["max"]), np.atleast_1d(values.max(axis=0)))
    for accessor in parts["accessors"]:
        assert accessor["count"] > 0
        assert np.isfinite(accessor.get("max", [0.0])).all()
    for name in ("skin", "tongue"):
        weights = player.weights(name)
        assert 52 <= len(player.target_names(name)) == weights.shape[1] <= 250
        assert weights.min() >= 0.0
        assert weights.max() <= 1.0


def test_the_texture_is_the_right_way_up(clip, glb):
    """Each vertex has the texture colour of the scene, although v points down in glTF."""
    player = Player(glb)
    skin = clip.skin
    albedo = clip.scene.skin.albedo
    assert skin.face_uv is not None
    material = player.file.materials[player.primitive("skin").material]
    assert material.doubleSided
    assert material.pbrMetallicRoughness.metallicFactor == 0.0
    picture = player.file.textures[material.pbrMetallicRoughness.baseColorTexture.index].source
    view = player.file.bufferViews[player.file.images[picture].bufferView]
    data = player.blob[view.byteOffset : view.byteOffset + view.byteLength]
    image = np.asarray(PIL.Image.open(io.BytesIO(data)), np.float64)
    assert image.shape == albedo.shape
    size = np.array(albedo.shape[:2][::-1])
    here = (player.attribute("skin", "TEXCOORD_0") * size).astype(int).clip(0, size - 1)
    uv = np.zeros((len(skin.rest), 2))
    uv[skin.faces] = skin.uv[skin.face_uv]
    downward = uv * [1.0, -1.0] + [0.0, 1.0]  # v of glTF grows downward
    there = (downward * size).astype(int).clip(0, size - 1)
    expected = albedo[there[:, 1], there[:, 0]].astype(np.float64)
    assert np.abs(image[here[:, 1], here[:, 0]] - expected).mean() < 4.0
    assert expected.std(axis=0).min() > 8.0  # otherwise any coordinate would pass


def test_fine_shape_is_a_normal_map(clip, glb):
    """The normal map has the slopes of the scene's fine shape, in each triangle's texture frame.

    Gradients of texture coordinates are means around vertices. trimesh finds this map and the
    occlusion map.
    """
    skin = clip.skin
    fine = clip.scene.skin.fine_shape
    scene = trimesh.load_scene(glb, process=False)
    skins = [mesh for name, mesh in scene.geometry.items() if name.startswith("skin")]
    material = skins[0].visual.material
    image = np.asarray(material.normalTexture.convert("RGB"), np.float64)
    assert image.shape == (*fine.slopes.shape[:2], 3)
    assert np.asarray(material.occlusionTexture).min() < 100
    size = np.array(image.shape[1::-1])
    checked = 0
    gradients = TextureGradients(skin.faces, skin.uv, skin.face_uv).measure(skin.rest)
    for face in range(0, len(skin.faces), 7):
        uv = skin.uv[skin.face_uv[face]].astype(float)
        points = skin.rest[skin.faces[face]]
        across, up = uv.mean(axis=0)
        column, row = (size * [across, 1.0 - up]).astype(int)
        middle = np.array([column + 0.5, size[1] - row - 0.5]) / size
        slope = (fine.slopes[row, column] - 128.0) * fine.steepest / 127.0
        uv_steps = np.diff(uv, axis=0)
        if abs(np.linalg.det(uv_steps)) < 4.0 / size.prod():
            continue  # too few texels, which a neighbour may have drawn
        along, aside = np.linalg.solve(uv_steps, np.diff(points, axis=0))
        outward = np.cross(along, aside)
        normal = outward / norm(outward)
        weights = np.linalg.solve(np.vstack([uv.T, np.ones(3)]), [*middle, 1.0])
        gradient = slope @ (weights @ gradients[skin.face_uv[face]]).reshape(2, 3)
        gradient -= gradient @ normal * normal
        right = along / norm(along)
        tilted = np.stack([right, np.cross(normal, right), normal]) @ (normal - gradient)
        expected = 127.5 + 127.5 * tilted / norm(tilted)
        assert np.abs(image[row, column] - expected).max() < 1.0
        checked += 1
    assert checked > 150
    assert image[..., :2].std() > 2.0


def test_vertex_colours_are_linear_light(clip, glb):
    """The file has linear colours: converted to sRGB, they are the eyes' painted colours."""
    painted = next(s.colours for s in clip.surfaces if s.name == "eyeball_left")
    assert painted is not None
    light = Player(glb).attribute("eyeball_left", "COLOR_0").astype(np.float64)
    shown = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.abs(shown - painted).max() < 1e-4
    assert np.ptp(painted) > 0.3


def test_scenes_without_a_face_are_written_too(tmp_path):
    """A scene without a face, such as a sheet, is written with morph targets."""
    text = 'scene = "plane"\n[[pose]]\ntime = 0\n[[pose]]\ntime = 0.6\namplitude = 1\nphase = 0.4\n'
    clip = record(parse_script(text, source="test"), None, 20.0, progress=False)
    assert written(clip, tmp_path / "sheet.glb").startswith("0 named targets and ")
    player = Player(tmp_path / "sheet.glb")
    for surface in clip.surfaces:
        assert farthest(player, clip, surface.name) < TOLERANCE


@pytest.mark.blender
def test_blender_sees_the_same(clip, glb, tmp_path):
    """Blender imports the file, and has each vertex at its place in every frame."""
    found = positions_in_blender(glb, tmp_path, 24.0, clip.frame_count)
    with np.load(found) as positions:
        assert set(positions) >= {surface.name for surface in clip.surfaces}
        for surface in clip.surfaces:
            expected = np.stack([surface.at(k) for k in range(clip.frame_count)]) / 1000.0
            off = norm(positions[surface.name] - expected, axis=2)
            assert off.max() < TOLERANCE, surface.name


@pytest.mark.slow
def test_the_error_of_too_few_targets_is_reported(clip, tmp_path, monkeypatch):
    """If a clip needs more targets than allowed, the remaining error is reported."""
    monkeypatch.setattr(gltf, "decompose", functools.partial(decompose, most=4))
    remark = written(clip, tmp_path / "rough.glb")
    player = Player(tmp_path / "rough.glb")
    error = 1000.0 * max(farthest(player, clip, name) for name in ("skin", "tongue"))
    assert remark is not None
    assert f"{error:.2f} mm" in remark
    assert "more targets than readers take" in remark
    assert error > 1.0


def test_targets_have_the_names_and_the_forms_of_an_avatar(clip, glb):
    """The first 52 targets have ARKit's names and the rest shape of each control.

    The others are named as residuals.
    """
    player = Player(glb)
    names = player.target_names("skin")
    named = names[:52]
    residual = names[52:]
    assert tuple(named) == ARKIT_SHAPES
    assert residual == [f"residual {number}" for number, _ in enumerate(residual, start=1)]
    shapes = player.shapes("skin")
    for name in ("jawOpen", "mouthSmileLeft", "eyeBlinkRight"):
        moved = rest_in(clip.scene.clone(), {name: 1.0}).skin - clip.skin.rest
        assert np.abs(1000.0 * shapes[name] - moved).max() < 0.02, name
    out = player.shapes("tongue")["tongueOut"]
    assert np.abs(out).max() > 0.01
    assert np.abs(player.shapes("tongue")["mouthSmileLeft"]).max() == 0.0


def test_named_targets_alone_follow_the_motion(clip, tmp_path):
    """Without residual targets, one line reports the error; all weights are from 0 to 1."""
    path = tmp_path / "named.glb"
    remark = write(clip, path, format_for(path, None), ExportRequest(named_only=True))
    player = Player(path)
    assert tuple(player.target_names("skin")) == ARKIT_SHAPES
    assert "52 named targets and 0 residual ones" in remark
    assert 0.5 < 1000.0 * farthest(player, clip, "skin") < 8.0  # [mm], of 50 that the skin moves
    # Only one ARKit shape moves the tongue: tongueOut.
    error = 1000.0 * farthest(player, clip, "tongue")
    assert f"at most {error:.2f} mm from the simulation (tongue)" in remark
    weights = player.weights("skin")
    assert 0.0 <= weights.min() and weights.max() <= 1.0


def test_weights_of_shapes_come_back_by_name(tmp_path):
    """Weights of ARKit's targets repeat a take of ARKit shapes, with the face's delay."""
    script = parse_script(TAKE, source="test")
    path = tmp_path / "take.glb"
    written(record(script, None, 12.0, progress=False), path)
    player = Player(path)
    weights = dict(zip(player.target_names("skin"), player.weights("skin").T, strict=True))
    assert weights["jawOpen"][-1] == pytest.approx(0.6, abs=0.1)
    assert weights["mouthSmileLeft"][-1] == pytest.approx(0.8, abs=0.1)
    assert weights["mouthSmileRight"].max() < 0.1
    assert weights["eyeBlinkLeft"].max() < 0.1


@pytest.mark.slow
def test_our_own_file_is_a_head_to_fit(head, glb, tmp_path):
    """An exported file can be fitted as a head; cards of hair are left out.

    The skin stays in place.
    """
    marks = tmp_path / "own.json"
    marks.write_text(json.dumps((head.vertices[head.landmarks] / 1000.0).tolist()))
    fitted = fit_head(glb, marks)
    assert fitted.faces.shape == head.faces.shape
    assert np.abs(fitted.vertices[fitted.landmarks] - head.vertices[head.landmarks]).max() < 0.1


def test_folds_of_lids_are_in_the_normal_map():
    """Folds of lids that show at rest are in the normal map, added to the fine shape."""
    person = person_called("maria")
    surface = MovingSurface(
        "skin", person.vertices, person.faces, uv=person.uv, face_uv=person.face_uv
    )
    with_folds, without = (
        _normal_map(surface, person.fine_shape, each).astype(int)
        for each in (person.wrinkles, None)
    )
    rows, columns = np.nonzero(np.abs(with_folds - without).max(axis=2) > 20)
    size = len(without)
    lid = person.uv[person.anatomy["palpebrale_superius_left"]] * [size, -size] + [0.0, size]
    near = np.hypot(columns - lid[0], rows - lid[1]) < 40.0
    assert near.sum() > 100
