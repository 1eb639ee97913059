"""Avatars move like the simulation, by named shapes on the vertices of the file."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.linalg import norm
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.rig.avatar import RigRequest, file_head
from risorius.app.rig.glb import Glb
from risorius.app.rig.linearity import corrective_poses, table
from risorius.app.rig.poses import rest_in
from risorius.app.rig.scene_meshes import Piece, add_mesh
from risorius.app.rig.surface import MovingSurface
from risorius.app.scenes import FaceScene
from risorius.assets.coarse import coarse_head
from risorius.assets.fitting import fit_head, simplifying
from risorius.assets.fitting.topologies import recognised
from risorius.assets.meshes import read_mesh
from risorius.geometry.normals import vertex_normals

from ..heads import TURN_MATRIX, user_head
from .command_line import refusal, risorius, shape_keys_in_blender, succeeded
from .glb_player import Player, document
from .rig_files import LIBRARY_NAME, PICTURE_NAME, write_whole_head

pytestmark = pytest.mark.usefixtures("shared_fits")

METRES_PER_MILLIMETRE = 0.001
INVISIBLE_ERROR = 0.02  # [mm], an invisible distance


@pytest.fixture(scope="module")
def built_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The avatar of the built-in head."""
    path = tmp_path_factory.mktemp("rig") / "head.glb"
    output = succeeded("rig", "-o", path)
    assert "52 shapes" in output
    assert "jawOpen + mouthPucker: at most" in output
    assert re.search(r"Speech: at most \d+\.\d mm, RMS 0\.\d", output)
    return path


def test_shapes_are_where_the_simulation_rests(built_in, face):
    """The avatar has ARKit's 52 shapes in Apple's order.

    Each moves the skin like its control at 1.
    """
    player = Player(built_in)
    shapes = player.shapes("skin")
    assert tuple(shapes) == ARKIT_SHAPES
    assert (
        np.abs(
            player.attribute("skin", "POSITION") - METRES_PER_MILLIMETRE * face.rest_positions
        ).max()
        < 1e-6
    )
    for name in ("jawOpen", "mouthSmileLeft", "eyeBlinkRight", "cheekPuff"):
        moved = rest_in(face, {name: 1.0}).skin - face.rest_positions
        assert np.abs(moved).max() > 3.0
        assert np.abs(shapes[name] / METRES_PER_MILLIMETRE - moved).max() < INVISIBLE_ERROR, name


def test_an_avatar_of_ours_needs_no_landmarks(built_in, face):
    """The project's own avatar is recognised by its vertices, although seams double some."""
    mesh = read_mesh(built_in)
    known = recognised(mesh)
    assert known.name == "the built-in head"
    places = np.abs(
        mesh.vertices[known.landmarks] - METRES_PER_MILLIMETRE * face.rest_positions[face.landmarks]
    )
    assert places.max() < 1e-6


def test_shares_of_bones_stay_within_their_limits(face):
    """Bone weights rounded above 1 become 1, so that no other weight is below 0."""
    surface = MovingSurface("skin", face.rest_positions, face.faces)
    none = np.zeros((0, *surface.rest.shape))
    normals = vertex_normals(surface.rest, surface.faces)
    piece = Piece(surface, None, normals, (), none, none, np.zeros((0, 0)))
    glb = Glb()
    add_mesh(glb, face, piece, np.zeros(3), np.full(len(surface.rest), 1.0 + 1e-7))
    attributes = glb.parts["meshes"][0]["primitives"][0]["attributes"]
    accessor = glb.parts["accessors"][attributes["WEIGHTS_0"]]
    view = glb.parts["bufferViews"][accessor["bufferView"]]
    weights = np.frombuffer(glb.data(), np.float32, 4 * accessor["count"], view["byteOffset"])
    assert 0.0 <= weights.min() and weights.max() <= 1.0


def test_mouth_close_shuts_an_open_jaw(built_in, face):
    """mouthClose is added to jawOpen, as ARKit defines it."""
    shapes = Player(built_in).shapes("skin")
    shut = (shapes["jawOpen"] + shapes["mouthClose"]) / METRES_PER_MILLIMETRE + face.rest_positions
    upper, lower = face.landmarks[[62, 66]]
    opened = shapes["jawOpen"] / METRES_PER_MILLIMETRE + face.rest_positions
    assert opened[upper, 1] - opened[lower, 1] > 15.0
    assert abs(shut[upper, 1] - shut[lower, 1]) < 3.0


def test_parts_have_the_shapes_that_move_them(built_in):
    """Lower teeth and tongue have shapes that move them; hair has none, and eyes are nodes."""
    player = Player(built_in)
    assert tuple(player.shapes("teeth_lower")) == ARKIT_SHAPES
    lowered = player.shapes("teeth_lower")["jawOpen"][:, 1]
    assert lowered.max() < -0.005
    assert np.abs(player.shapes("teeth_lower")["mouthSmileLeft"]).max() == 0.0
    assert np.abs(player.shapes("tongue")["tongueOut"]).max() > 0.01
    assert not player.shapes("hair") and not player.shapes("eyeball_left")
    nodes = {node["name"]: node for node in document(built_in)["nodes"]}
    turns = nodes["eye_left"]["extras"]["rotations"]
    assert set(turns) == {f"eyeLook{way}Left" for way in ("Up", "Down", "In", "Out")}
    assert turns["eyeLookDownLeft"][0] > 0.2  # forward about the x axis


@pytest.mark.blender
def test_blender_has_the_shapes_by_name(built_in, tmp_path):
    """In Blender, each shape key with an ARKit name moves the vertices as in the file."""
    found = shape_keys_in_blender(built_in, tmp_path)
    shapes = Player(built_in).shapes("skin")
    with np.load(found) as keys:
        assert set(shapes) <= {name.partition("/")[2] for name in keys}
        for name, shape in shapes.items():
            # Blender's axes have z up.
            x, y, z = shape.T
            assert np.abs(keys[f"skin/{name}"] - np.column_stack([x, -z, y])).max() < 1e-5, name


def test_most_of_a_shape_takes_no_room(built_in):
    """Shapes store moved vertices only."""
    found = document(built_in)
    targets = [
        found["accessors"][target["POSITION"]]
        for mesh in found["meshes"]
        for target in mesh["primitives"][0].get("targets", ())
    ]
    in_sparse = sum(each["sparse"]["count"] for each in targets if "sparse" in each)
    in_dense = sum(each["count"] for each in targets if "bufferView" in each)
    in_all = sum(each["count"] for each in targets)
    assert in_sparse + in_dense < 0.35 * in_all


@dataclass(frozen=True)
class Whole:
    """A head with parts, its avatar, and the printed report."""

    mesh: Path
    places: dict[str, slice]
    avatar: Path
    lines: str


@pytest.fixture(scope="module")
def whole(scene: FaceScene, shared_fits: None, tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """The avatar of an OBJ file."""
    folder = tmp_path_factory.mktemp("whole")
    mesh, landmarks, places = write_whole_head(folder, scene)
    output = succeeded("rig", mesh, "--landmarks", landmarks, "-o", folder / "whole.glb")
    return Whole(mesh, places, folder / "whole.glb", output)


def test_a_file_keeps_its_vertices_in_their_order(whole):
    """All vertices and triangles are in order, with texture coordinates, material and picture."""
    mesh = read_mesh(whole.mesh)
    player = Player(whole.avatar)
    points = player.attribute("head", "POSITION")
    assert np.array_equal(points[: len(mesh.vertices)], mesh.vertices.astype(np.float32))
    assert tuple(player.shapes("head")) == ARKIT_SHAPES
    found = document(whole.avatar)
    count = 0
    for each in found["meshes"]:
        for primitive in each["primitives"]:
            count += found["accessors"][primitive["indices"]]["count"] // 3
    assert count == len(mesh.faces)
    assert [each["name"] for each in found["materials"]].count("skin") == 1
    view = found["bufferViews"][found["images"][0]["bufferView"]]
    content = Player(whole.avatar).blob[view["byteOffset"] :][: view["byteLength"]]
    assert content == (whole.mesh.parent / PICTURE_NAME).read_bytes()


def test_each_piece_of_a_file_moves_by_its_role(whole, face):
    """Teeth move with the jaw, lashes with the lids, the tongue comes out.

    The rest stands still.
    """
    shapes = {
        name: 100.0 * each / 10.0 for name, each in Player(whole.avatar).shapes("head").items()
    }
    own = {
        piece: {name: moved[place] for name, moved in shapes.items()}
        for piece, place in whole.places.items()
    }
    assert own["skin"]["jawOpen"][:, 1].min() < -20.0
    assert own["teeth_lower"]["jawOpen"][:, 1].max() < -5.0
    assert own["gums_lower"]["jawOpen"][:, 1].max() < -5.0
    assert np.abs(own["teeth_upper"]["jawOpen"]).max() == 0.0
    assert np.abs(own["tongue"]["tongueOut"]).max() > 10.0
    assert own["lashes"]["eyeBlinkLeft"][:, 1].min() < -5.0
    for name in ("hair", "shirt", "teeth_upper"):
        assert np.abs([*own[name].values()]).max() < 0.1, name
    assert "eyeball, turns with the left eye" in whole.lines
    assert "tongue, bends" in whole.lines
    assert re.search(r"^piece \d+ \(shirt\): \d+ vertices at .*: body", whole.lines, re.M)
    assert "body or clothes, without motion" in whole.lines
    skin = rest_in(face, {"jawOpen": 1.0}).skin - face.rest_positions
    off = np.abs(own["skin"]["jawOpen"] - skin)
    assert np.median(off) < 0.5  # the parts were fitted again


def test_eyeballs_of_a_file_become_nodes(whole, face):
    """Each eyeball is a node at the centre of its ball; the root scales the unit to metres."""
    nodes = {node["name"]: node for node in document(whole.avatar)["nodes"]}
    for eye in face.head.eyes:
        centre = 10.0 * np.array(nodes[f"eye_{eye.name}"]["translation"])
        assert norm(centre - eye.centre) < 1.0
    scale = np.array(nodes["whole"]["matrix"]).reshape(4, 4)[0, 0]
    assert scale == approx(0.01)


def test_the_file_is_read_by_trimesh(whole):
    """trimesh reads the avatar at the same size."""
    scene = trimesh.load_scene(whole.avatar, process=False)
    assert 0.3 < scene.extents[1] < 0.8


@pytest.mark.slow
def test_an_option_corrects_the_role_of_a_piece(whole, tmp_path):
    """An option corrects the role of pieces, and leaves out pieces; eyes turn by the shapes."""
    landmarks = whole.mesh.with_suffix(".json")
    path = tmp_path / "other.glb"
    corrections = ("--piece", "tongue=hair", "--piece", "shirt=hidden")
    given = (*corrections, "--eyes", "targets", "--shapes", "expressions,arkit")
    succeeded("rig", whole.mesh, "--landmarks", landmarks, "-o", path, *given)
    player = Player(path)
    mesh = player.file.meshes[player.file.nodes[player.numbers["head"]].mesh]
    drawn = np.concatenate([player.values(each.indices) for each in mesh.primitives])
    assert not np.isin(drawn, np.r_[whole.places["shirt"]]).any()
    assert np.isin(drawn, np.r_[whole.places["teeth_upper"]]).any()
    shapes = player.shapes("head")
    assert len(shapes["joy"]) >= whole.places["shirt"].stop
    assert "joy" in shapes and len(shapes) > 52
    assert np.abs(shapes["tongueOut"][whole.places["tongue"]]).max() == 0.0
    assert np.abs(shapes["eyeLookUpLeft"][whole.places["eyeball_left"]]).max() > 0.2


def test_correctives_make_sums_come_true(tmp_path):
    """A corrective is a shape for a pair, weighted by the product of both weights.

    The file stores this rule. Both shapes and the corrective add up to the simulated pair.
    """
    face = FaceScene(coarse_head())
    path = tmp_path / "head.glb"
    succeeded("rig", "coarse", "-o", path, "--correctives", 2, "--quiet")
    found = document(path)
    rules = found["meshes"][0]["extras"]["correctives"]
    assert len(rules) == 2
    shapes = Player(path).shapes("skin")
    for rule in rules:
        pair = rule["product"]
        assert rule["name"] == "_".join(pair)
        together = rest_in(face, dict.fromkeys(pair, 1.0)).skin - face.rest_positions
        summed = sum(shapes[name] for name in (*pair, rule["name"])) / METRES_PER_MILLIMETRE
        assert np.abs(summed - together).max() < 5 * INVISIBLE_ERROR
        plain = sum(shapes[name] for name in pair) / METRES_PER_MILLIMETRE
        assert np.abs(plain - together).max() > 3.0


def test_printed_errors_include_the_correctives(face):
    """In the printed table of pairs, a pair with a corrective has no error."""
    pair = ("jawOpen", "mouthPucker")
    rest = rest_in(face, {})
    poses = {name: (rest_in(face, {name: 1.0}), rest) for name in pair}
    (plain,) = table(face, poses)
    (corrected,) = table(face, {**poses, **corrective_poses(face, [pair])}, [pair])
    assert plain.most > 3.0
    assert corrected.most < INVISIBLE_ERROR


@pytest.mark.slow
def test_a_take_shows_how_far_sums_are_off(tmp_path, face):
    """A take of one shape has no error; with two shapes at 1 the line has the pair's error."""
    take = tmp_path / "take.toml"
    still = 'title = "Still"\nduration = 1.0\n[[pose]]\ntime = 0.0\n'
    off = {}
    for words in ("jawOpen = 1.0\n", "jawOpen = 1.0\nmouthPucker = 1.0\n"):
        take.write_text(still + words)
        result = risorius("rig", "-o", tmp_path / "a.glb", "--take", take)
        assert result.exit_code == 0, result.output
        line = next(line for line in result.output.splitlines() if "Still" in line)
        off[words] = float(re.search(r"at most (\d+\.\d) mm", line)[1])
    alone, both = off.values()
    assert alone < 0.2
    shapes = [rest_in(face, {name: 1.0}).skin for name in ("jawOpen", "mouthPucker")]
    together = rest_in(face, {"jawOpen": 1.0, "mouthPucker": 1.0}).skin
    expected = norm(sum(shapes) - face.rest_positions - together, axis=1).max()
    assert both == approx(expected, abs=0.2)
    path = tmp_path / "corrected.glb"
    result = risorius("rig", "-o", path, "--take", take, "--correctives", 2)
    assert "correctives: jawOpen_mouthPucker" in result.output
    assert "jawOpen + mouthPucker: at most 0.0 mm" in result.output
    (first, *_) = document(path)["meshes"][0]["extras"]["correctives"]
    assert first["product"] == ["jawOpen", "mouthPucker"]  # selected by the take
    line = next(line for line in result.output.splitlines() if "Still" in line)
    assert float(re.search(r"at most (\d+\.\d) mm", line)[1]) < 0.3 * both
    words = ("--shapes", "units", "--take", take)
    assert "--shapes" in refusal(risorius("rig", "-o", tmp_path / "b.glb", *words))


@pytest.mark.slow
def test_a_finer_head_follows_a_coarser_one(tmp_path, monkeypatch):
    """A mesh with too many triangles to simulate has shapes on all its own vertices."""
    monkeypatch.setattr(simplifying, "MOST_SIMULATED", 5000)
    monkeypatch.setattr(simplifying, "SIMPLIFIED_COUNT", 4000)
    fine = user_head(1)
    assert len(fine.mesh.faces) > 5000
    mesh, landmarks = fine.write(tmp_path)
    path = tmp_path / "fine.glb"
    output = succeeded("rig", mesh, "--landmarks", landmarks, "-o", path)
    assert "following a simplified mesh" in output
    assert "not in the file: eyes, teeth, tongue, inside of the mouth; --parts" in output
    player = Player(path)
    points = player.attribute("head", "POSITION")
    assert np.abs(points[: len(fine.mesh.vertices)] - fine.mesh.vertices).max() < 1e-6
    shapes = player.shapes("head")
    assert tuple(shapes) == ARKIT_SHAPES
    upper, lower = fine.landmarks[[62, 66]]
    down = shapes["jawOpen"] @ TURN_MATRIX.T
    assert (down[lower, 1] < -0.02) and (abs(down[upper, 1]) < 0.006)
    assert norm(shapes["eyeBlinkLeft"], axis=1).max() > 0.005


def test_a_folder_of_objs_keeps_the_lines_of_the_file(whole, tmp_path):
    """Each shape has an OBJ with the same vertices; only lines of moved vertices differ."""
    landmarks = whole.mesh.with_suffix(".json")
    folder = tmp_path / "shapes"
    output = succeeded("rig", whole.mesh, "--landmarks", landmarks, "--as", "obj", "-o", folder)
    assert {path.stem for path in folder.glob("*.obj")} == {"neutral", *ARKIT_SHAPES}
    assert f"52 shapes, {len(ARKIT_SHAPES) + 1} meshes" in output
    others = {path.name for path in folder.iterdir() if path.suffix != ".obj"}
    assert others == {LIBRARY_NAME, PICTURE_NAME}
    for name in others:
        assert (folder / name).read_bytes() == (whole.mesh.parent / name).read_bytes()
    lines = whole.mesh.read_text().splitlines()
    assert (folder / "neutral.obj").read_text().splitlines() == lines
    picture = read_mesh(folder / "neutral.obj").texture.pictures[0]()
    assert picture[0, 0].tolist() == [200, 150, 130]
    opened = (folder / "jawOpen.obj").read_text().splitlines()
    assert len(opened) == len(lines)
    for before, after in zip(lines, opened, strict=True):
        assert before == after or (before.startswith("v ") and after.startswith("v "))
    moved = read_mesh(folder / "jawOpen.obj").vertices - read_mesh(whole.mesh).vertices
    shape = Player(whole.avatar).shapes("head")["jawOpen"]
    assert np.abs(moved - shape[: len(moved)]).max() < 1e-5


def test_wrong_options_are_refused(whole, tmp_path):
    """A wrong option is refused in one line with the allowed values."""
    landmarks = whole.mesh.with_suffix(".json")
    unknown, _ = user_head().write(whole.mesh.parent)
    head = (whole.mesh, "--landmarks", landmarks)
    for words, expected in (
        (("-o", tmp_path / "a.fbx"), ".glb"),
        ((unknown, "-o", tmp_path / "a.glb"), "needs a landmark file"),
        ((3, "--landmarks", landmarks, "-o", tmp_path / "a.glb"), "--landmarks"),
        (("-o", tmp_path / "a.glb", "--shapes", "arkit,cats"), "cats"),
        ((*head, "-o", tmp_path / "a.glb", "--piece", "9000=hair"), "pieces 1 to"),
        ((*head, "-o", tmp_path / "a.glb", "--piece", "1=wing"), "upper_teeth"),
    ):
        assert expected in refusal(risorius("rig", *words)), words
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("change", ["moved", "fewer"])
def test_a_file_that_changed_since_it_was_read_is_refused(tmp_path, change):
    """A file changed after it was read is refused, because vertex indices may differ.

    The window makes avatars long after reading.
    """
    brought = user_head()
    mesh, marks = brought.write(tmp_path)
    head = fit_head(mesh, marks)
    lines = mesh.read_text().splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("v "))
    if change == "moved":
        lines[first] = "v 1 2 3"
    else:
        lines = ["v 0 0 0", "v 1 0 0", "v 0 1 0", "f 1 2 3"]
    mesh.write_text("\n".join(lines) + "\n")
    with pytest.raises(UserError, match="has changed since it was read; open it again"):
        file_head(head, RigRequest(), print)
