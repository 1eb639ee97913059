"""Files with the refined skin: one topology in all frames, read by other readers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.linalg import norm
from numpy.testing import assert_array_equal
from pxr import Usd, UsdGeom

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.export.clip import Clip, record
from risorius.app.export.formats import ExportRequest, check_request, format_for, write
from risorius.app.export.refined import RefinedClip, with_refined_skin
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.refining.presets import Refinement
from risorius.app.rig.surface import RefinedSurface
from risorius.app.scenes import FaceScene
from risorius.app.script.script_file import parse_script
from risorius.geometry.directions import unit_vectors
from tests.sim.poses import advance

from .glb_player import Player

SCRIPT = """
duration = 0.4
[[pose]]
time = 0.0
[[pose]]
time = 0.4
joy = 1.0
jaw_open = 0.6
head_yaw = 0.8
"""


@pytest.fixture(scope="module")
def clip() -> Clip:
    """A face that smiles, opens its mouth and turns."""
    return record(parse_script(SCRIPT, source="test"), FaceScene(), 12.0, progress=False)


@pytest.fixture(scope="module")
def refined(clip: Clip) -> RefinedClip:
    """The same clip with skin refined by the paper's rule."""
    return with_refined_skin(clip, Refinement("paper"))


def written(refined, path):
    """Write the clip; return the printed remark."""
    return write(refined.clip, path, format_for(path, None), ExportRequest(progress=False))


def test_one_topology_that_no_frame_is_finer_than(clip, refined):
    """The skin has all triangles that a frame needs, and is near each separately refined frame."""
    counts = [len(mesh.triangles) for mesh in clip.refined(Refinement("paper"))]
    assert (refined.fewest, refined.most) == (min(counts), max(counts))
    assert len(clip.skin.faces) < max(counts) <= len(refined.clip.skin.faces)
    assert 0.0 < refined.mean < 0.2
    # Where the paper's rule splits a long edge, it moves both its vertices by millimetres.
    assert refined.mean < refined.farthest < 10.0
    assert str(len(refined.clip.skin.faces)) in refined.words


def test_frames_are_those_of_a_refiner_with_the_same_splits(clip, refined):
    """Vertices and normals of every frame equal the refiner's; parts are unchanged."""
    scene = clip.scene
    changing = refine.create(
        "kahler", scene.faces, scene.rest_positions, scene.skin.uv, scene.skin.face_uv
    )
    frames = [clip.skin.at(frame) for frame in range(clip.frame_count)]
    splits = refine.splits_of_clip(changing, frames)
    fixed = refine.create(
        "kahler",
        scene.faces,
        scene.rest_positions,
        scene.skin.uv,
        scene.skin.face_uv,
        splits=splits,
    )
    skin = refined.clip.skin
    for number, frame in enumerate(frames):
        mesh = fixed.refine(frame)
        assert_array_equal(skin.faces, mesh.triangles)
        assert_array_equal(skin.source, mesh.source)
        assert_array_equal(skin.at(number), mesh.positions)
        assert_array_equal(skin.normals_of(skin.at(number), number), mesh.normals)
    assert refined.clip.surfaces[1:] == clip.surfaces[1:]


def test_gltf_plays_the_refined_skin(refined, tmp_path):
    """Morph targets and the head's bone place refined vertices within a tenth of a millimetre."""
    path = tmp_path / "face.glb"
    remark = written(refined, path)
    assert remark is not None and "at most 0." in remark
    player = Player(path)
    skin = refined.clip.skin
    assert tuple(player.target_names("skin")[:52]) == ARKIT_SHAPES
    assert 1000.0 * norm(player.shapes("skin")["jawOpen"], axis=1).max() > 20.0
    indices = player.values(player.primitive("skin").indices).reshape(-1, 3)
    for frame in range(refined.clip.frame_count):
        corners = player.positions("skin", frame)[indices]
        off = norm(corners - skin.at(frame)[skin.faces] / 1000.0, axis=2)
        assert off.max() < 1.2e-4
    last = refined.clip.frame_count - 1
    assert isinstance(skin, RefinedSurface)
    head = np.asarray(refined.clip.bones["cranium"][last])[:3, :3]
    normals = player.shape("skin", last, "NORMAL")
    normals = unit_vectors(normals)
    turned = normals[indices] @ head.T  # of vertices that follow the head fully
    share = skin.carried(refined.clip.scene.simulation.bones.head_weight)
    goes_along = share[skin.faces] > 0.999
    angles = (turned * skin.normals[last][skin.faces]).sum(axis=2)[goes_along]
    assert np.degrees(np.arccos(np.clip(np.percentile(angles, 2), -1.0, 1.0))) < 3.0


def test_usd_stores_the_triangles_once(refined, tmp_path):
    """Triangles are stored once, points for each time."""
    path = tmp_path / "face.usdz"
    written(refined, path)
    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/face/skin"))
    assert mesh.GetFaceVertexIndicesAttr().GetNumTimeSamples() == 0
    assert mesh.GetPointsAttr().GetNumTimeSamples() == refined.clip.frame_count
    points = np.array(mesh.GetPointsAttr().Get(refined.clip.frame_count - 1))
    assert_array_equal(points, refined.clip.skin.at(refined.clip.frame_count - 1))


def test_arrays_and_point_caches_have_the_refined_vertices(refined, tmp_path):
    """In npz, `positions` has all refined vertices; a point cache begins with them."""
    path = tmp_path / "face.npz"
    written(refined, path)
    with np.load(path) as arrays:
        assert_array_equal(arrays["positions"], refined.clip.skin.shapes)
        assert_array_equal(arrays["source"], refined.clip.skin.source)
    cache = tmp_path / "face.pc2"
    written(refined, cache)
    count = sum(len(each.rest) for each in refined.clip.surfaces)
    assert cache.stat().st_size == 32 + 12 * count * refined.clip.frame_count


@pytest.mark.parametrize("look", ["paper", "smooth"])
def test_a_pose_that_is_held(look):
    """In a held pose, all frames and the file have triangles other than those at rest."""
    held = "duration = 0.2\n[[pose]]\ntime = 0.0\njoy = 1.0\n"
    scene = FaceScene()
    scene.pose({"joy": 1.0})
    advance(scene, 60)
    clip = record(parse_script(held, source="test"), scene, 10.0, progress=False)
    shapes = np.repeat(clip.skin.shapes[-1:], clip.frame_count, axis=0)
    still = replace(clip, surfaces=(replace(clip.skin, shapes=shapes), *clip.surfaces[1:]))
    refined = with_refined_skin(still, Refinement(look))
    assert refined.fewest == refined.most <= len(refined.clip.skin.faces)
    assert refined.clip.skin.shapes.shape[1:] == refined.clip.skin.rest.shape


def test_a_refiner_that_never_changes_needs_no_splits(clip):
    """Uniform Loop has the same triangles in all frames, so it needs no splits of the clip."""
    uniform = with_refined_skin(clip, Refinement(refiner="loop"))
    assert len(uniform.clip.skin.faces) == 4 * len(clip.skin.faces)
    assert uniform.words == f"refined skin of {4 * len(clip.skin.faces)} triangles"


@pytest.mark.parametrize(
    ("name", "request_", "error"),
    [
        ("face.glb", ExportRequest(changes=True), "--changing needs --refined"),
        (
            "face.glb",
            ExportRequest(Refinement(), changes=True),
            "cannot be written as glTF.*usd, obj, vtkhdf",
        ),
        ("face.csv", ExportRequest(Refinement()), "--refined: cannot be written as ARKit"),
        ("face.npz", ExportRequest(named_only=True), "--named-only: cannot be written as numpy"),
    ],
)
def test_mistakes_are_reported(name, request_, error, tmp_path: Path):
    """A format is refused in one line if it has no mesh, or only the base mesh's triangles."""
    path = tmp_path / name
    with pytest.raises(UserError, match=error):
        check_request(path, format_for(path, None), request_)
