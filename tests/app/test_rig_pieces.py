"""Pieces of a head's file: the role found for each, and their names in lines and options."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest
import trimesh

from risorius.app.errors import UserError
from risorius.app.rig.pieces import (
    FilePiece,
    corrected,
    described,
    find_pieces,
    without_helpers,
)
from risorius.app.scenes import FaceScene
from risorius.assets.fitting import eyeballs
from risorius.geometry.arrays import Flags, Floats64
from risorius.geometry.normals import vertex_normals
from tests.assets.checks import part_of

Triangles = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Maker:
    """A maker of pieces for the built-in head [mm]: vertices and triangles."""

    scene: FaceScene

    def landmark(self, number: int) -> Floats64:
        """The place of a landmark."""
        place: Floats64 = self.scene.rest_positions[self.scene.landmarks[number]]
        return place

    def part(self, name: str) -> tuple[Floats64, Triangles]:
        """A part of the built-in head."""
        part = part_of(self.scene, name)
        return np.array(part.vertices, np.float64), np.array(part.faces, np.int64)

    def shell(self, chosen: Flags, off: float) -> tuple[Floats64, Triangles]:
        """A piece at this distance outside selected skin."""
        points = self.scene.rest_positions
        faces = self.scene.faces
        used, number = np.unique(faces[chosen[faces].all(axis=1)], return_inverse=True)
        normals = vertex_normals(points, faces)
        return points[used] + off * normals[used], number.reshape(-1, 3)

    def ball(self, side: str, share: float, forward: float) -> tuple[Floats64, Triangles]:
        """A ball in an eye with this fraction of its radius, moved forward by fractions of it."""
        eye = next(each for each in self.scene.face.head.eyes if each.name == side)
        ball = trimesh.creation.icosphere(subdivisions=2, radius=share * eye.radius)
        centre = eye.centre + np.array([0.0, 0.0, forward * eye.radius])
        return np.asarray(ball.vertices) + centre, np.asarray(ball.faces)


def beard(maker: Maker) -> tuple[Floats64, Triangles]:
    """A copy of the skin of chin and jaw, with long hairs below."""
    _, height, depth = maker.scene.rest_positions.T
    lip = maker.landmark(57)[1]
    chin = maker.landmark(8)[1]
    is_low = (height < lip - 4.0) & (height > chin - 5.0)
    shell, faces = maker.shell(is_low & (depth > 15.0), 2.0)
    shell[:, 1] -= 2.0 * np.maximum(chin + 5.0 - shell[:, 1], 0.0)
    return shell, faces


def sideburns(maker: Maker) -> tuple[Floats64, Triangles]:
    """A full beard from the ears to the chin, without the lips."""
    across, height, depth = maker.scene.rest_positions.T
    nose = maker.landmark(33)[1]
    lip = maker.landmark(57)[1]
    chin = maker.landmark(8)[1]
    is_lip = (np.abs(across) < 27.0) & (height < nose - 4.0) & (height > lip - 3.0)
    is_low = (height < nose) & (height > chin - 8.0)
    return maker.shell(is_low & (depth > 0.0) & ~is_lip, 1.5)


def bow_tie(maker: Maker) -> tuple[Floats64, Triangles]:
    """A knot that touches the throat below the chin, in front of the jaw."""
    points = maker.scene.rest_positions
    chin = maker.landmark(8)
    is_in_middle = np.abs(points[:, 0]) < 15.0
    throat = points[is_in_middle & (points[:, 1] < chin[1] - 40.0)]
    front = throat[throat[:, 2].argmax()]
    depth = chin[2] - front[2] + 20.0
    knot = trimesh.creation.box((30.0, 20.0, depth)).subdivide()
    return np.asarray(knot.vertices) + front + np.array([0.0, 0.0, 0.5 * depth]), knot.faces


def glasses(maker: Maker) -> tuple[Floats64, Triangles]:
    """Two rims and a bridge in front of the eyes; the bridge touches the nose."""
    ring = trimesh.creation.torus(22.0, 1.2, 24, 6)
    rims = []
    for side in ("left", "right"):
        centre = maker.ball(side, 0.1, 0.0)[0].mean(axis=0)
        rims.append(np.asarray(ring.vertices) + centre + np.array([0.0, 0.0, 27.0]))
    bridge = maker.landmark(28) + np.array([0.0, 0.0, 2.0])
    count = len(ring.vertices)
    between = [[0, count, 2 * count]]
    faces = np.vstack([ring.faces, np.asarray(ring.faces) + count, between])
    return np.vstack([*rims, bridge]), faces


def deep_tongue(maker: Maker) -> tuple[Floats64, Triangles]:
    """A tongue whose root reaches down into the throat."""
    points, faces = maker.part("tongue")
    share = (points[:, 2].max() - points[:, 2]) / np.ptp(points[:, 2])
    points[:, 1] -= 30.0 * share**2
    points[:, 2] -= 20.0 * share
    return points, faces


def incisor(maker: Maker) -> tuple[Floats64, Triangles]:
    """An upper tooth with a long root, as a piece of its own."""
    points, _ = maker.part("teeth_upper")
    front = points[points[:, 2].argmax()]
    tooth = trimesh.creation.box((8.0, 30.0, 6.0)).subdivide().subdivide()
    place = np.array([front[0], points[:, 1].min() + 15.0, front[2] - 4.0])
    return np.asarray(tooth.vertices) + place, np.asarray(tooth.faces)


PIECE_CASES = {
    "ball": (lambda maker: maker.ball("left", 1.0, 0.0), "eye_left"),
    "large ball": (lambda maker: maker.ball("left", 1.5, -0.4), "eye_left"),
    "cornea": (lambda maker: maker.ball("right", 0.62, 0.45), "eye_right"),
    "iris": (lambda maker: maker.ball("left", 0.4, 0.62), "eye_left"),
    "teeth": (lambda maker: maker.part("teeth_lower"), "lower_teeth"),
    "incisor": (incisor, "upper_teeth"),
    "tongue": (lambda maker: maker.part("tongue"), "tongue"),
    "deep tongue": (deep_tongue, "tongue"),
    "lashes": (lambda maker: maker.part("lashes"), "on_skin"),
    "beard": (beard, "on_skin"),
    "sideburns": (sideburns, "on_skin"),
    "bow tie": (bow_tie, "body"),
    "glasses": (glasses, "hair"),
    "hair": (lambda maker: maker.part("hair"), "hair"),
}


def pieces_with(
    scene: FaceScene, own: tuple[Floats64, Triangles], name: str = ""
) -> list[FilePiece]:
    """The pieces of a file with the built-in skin and another piece."""
    points, faces = own
    count = len(scene.rest_positions)
    places = np.vstack([scene.rest_positions, points])
    corners = np.vstack([scene.faces, faces + count]).astype(np.int32)
    names = np.full(len(places), name, object)
    return find_pieces(places, corners, np.arange(count), scene.face.head, names)


@pytest.mark.parametrize("case", PIECE_CASES)
def test_each_piece_gets_its_role(face, case):
    """Roles are found for eyes in layers, teeth with roots, a deep tongue, a beard and glasses."""
    make, role = PIECE_CASES[case]
    assert {piece.role for piece in pieces_with(face, make(Maker(face)))} == {role}


def test_single_teeth_belong_to_their_row(face):
    """Lower molars that stand above the gap between the built-in rows are still lower teeth."""
    rows = {name: Maker(face).part(name)[0] for name in ("teeth_upper", "teeth_lower")}
    front = rows["teeth_upper"][:, 2].max()
    teeth = []
    roles = []
    for name, side in (("teeth_upper", 1.0), ("teeth_lower", -1.0)):
        heights = rows[name][:, 1]
        edge = heights.min() if side > 0.0 else heights.max()
        for along in np.linspace(-1.0, 1.0, 10):
            back = 35.0 * along**2
            rise = 6.0 * along**2
            place = (22.0 * along, edge + side * 4.0 + rise, front - 4.0 - back)
            teeth.append(np.asarray(trimesh.creation.box((5.0, 8.0, 5.0)).vertices) + place)
            roles.append("upper_teeth" if side > 0.0 else "lower_teeth")
    box = np.asarray(trimesh.creation.box().faces)
    faces = np.vstack([box + 8 * number for number in range(len(teeth))])
    pieces = pieces_with(face, (np.vstack(teeth), faces))
    assert [piece.role for piece in pieces] == roles


def arch(middle: float, front: float) -> tuple[Floats64, Triangles]:
    """A row of teeth in one piece, 8 mm high, around this height."""
    along = np.linspace(-1.0, 1.0, 21)
    line = np.column_stack([22.0 * along, np.full(21, middle), front - 35.0 * along**2])
    half_height = np.array([0.0, 4.0, 0.0])
    points = np.vstack([line - half_height, line + half_height])
    cell = np.array([[0, 1, 21], [1, 22, 21]])
    faces = cell + np.arange(20)[:, None, None]
    return points, faces.reshape(-1, 3)


@pytest.mark.parametrize("higher", [-8.0, 0.0, 9.0])
def test_two_rows_decide_where_the_jaws_part(face, higher):
    """Lower teeth and a tongue above the gap between the built-in rows are found by both rows.

    They were taken for upper teeth in heads with full lips, whose built-in teeth lie low.
    """
    maker = Maker(face)
    upper, lower = (maker.part(f"teeth_{row}")[0] for row in ("upper", "lower"))
    between = 0.5 * (upper[:, 1].min() + lower[:, 1].max())
    front = upper[:, 2].max() - 4.0
    tongue, tongue_faces = maker.part("tongue")
    tongue[:, 1] += between + higher - 2.0 - tongue[:, 1].max()
    made = [(tongue, tongue_faces)]
    made += [arch(between + higher + side * 6.0, front) for side in (1.0, -1.0)]
    starts = np.cumsum([0, *(len(points) for points, _ in made)])
    points = np.vstack([points for points, _ in made])
    faces = np.vstack([faces + start for (_, faces), start in zip(made, starts, strict=False)])
    roles = [piece.role for piece in pieces_with(face, (points, faces))]
    assert roles == ["tongue", "upper_teeth", "lower_teeth"]


def test_thousands_of_strands_need_no_costly_tests(face, monkeypatch):
    """No ball is fitted to strands of hair; a fit for each took seconds for a whole head."""
    monkeypatch.setattr(eyeballs, "sphere_of", lambda *_: pytest.fail("a ball was fitted"))
    strand = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 30.0, 0.0], [1.0, 30.0, 0.0]])
    count = 3000
    across = np.linspace(-80.0, 80.0, count)
    crown = face.rest_positions[:, 1].max() + 20.0
    roots = np.column_stack([across, np.full(count, crown), np.zeros(count)])
    points = (roots[:, None] + strand).reshape(-1, 3)
    faces = np.array([[0, 1, 2], [1, 3, 2]]) + 4 * np.arange(count)[:, None, None]
    pieces = pieces_with(face, (points, faces.reshape(-1, 3)))
    assert [piece.role for piece in pieces] == ["hair"] * count


def test_lines_have_the_names_of_the_file(face):
    """Lines have the file's object names, for one piece, a few, or many with one role."""
    (piece,) = pieces_with(face, Maker(face).part("tongue"), "Tongue")
    (line,) = described([piece])
    assert line.startswith("piece 1 (Tongue): ") and line.endswith("tongue, bends")
    centre = np.zeros(3)
    strands = [FilePiece(n, np.arange(4), "hair", centre, f"strand{n}") for n in range(1, 6)]
    assert described(strands)[0].startswith("pieces 1-5 (strand1, strand2, 3 more): 20 vertices")
    assert described([FilePiece(1, np.arange(4), "hair", centre)])[0].startswith("piece 1: ")


def test_an_option_names_pieces_by_number_or_name():
    """A name selects all pieces with it; an unknown name or number is refused in one line."""
    centre = np.zeros(3)
    pieces = [FilePiece(n, np.arange(4), "hair", centre, name) for n, name in enumerate("abba", 1)]
    roles = [piece.role for piece in corrected(pieces, ["a=on_skin", "2-3=body", "3=tongue"])]
    assert roles == ["on_skin", "body", "tongue", "on_skin"]
    for wrong, words in (("5=hair", "1 to 4"), ("c=hair", "none of this name"), ("a=hat", "roles")):
        with pytest.raises(UserError, match=words):
            corrected(pieces, [wrong])
    with pytest.raises(UserError, match="no piece beside the skin"):
        corrected([], ["1=hair"])


def test_auxiliary_geometry_of_makehuman_is_hidden():
    """Joints, blank hair and blank clothes are hidden; eyes, teeth and lashes are not.

    Blank hair hung over the face, and the cube of a joint was an eyeball.
    """
    roles = {
        ("joint-l-eye", "eye_left"): "hidden",
        ("helper-hair", "on_skin"): "hidden",
        ("helper-skirt", "body"): "hidden",
        ("helper-l-eye", "eye_left"): "eye_left",
        ("helper-upper-teeth", "upper_teeth"): "upper_teeth",
        ("helper-l-eyelashes-1", "on_skin"): "on_skin",
        ("hair", "hair"): "hair",
    }
    pieces = [FilePiece(1, np.arange(4), role, np.zeros(3), name) for name, role in roles]
    assert [piece.role for piece in without_helpers(pieces)] == [*roles.values()]
