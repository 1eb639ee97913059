"""Muscles and skull: valid surfaces that follow the face under translucent skin."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.linalg import norm
from PIL import Image
from pytest import approx

from risorius import render
from risorius.app.anatomy import STRUCTURES, AnatomyView, DrawnAnatomy
from risorius.app.anatomy.muscle_bands import ROW_COUNT, SECTION_POINTS, Muscles
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.drawing import camera_for
from risorius.app.scenes import FaceScene
from risorius.assets.coarse import coarse_head
from risorius.assets.fitting import fit_head
from risorius.geometry.closest import closest_points
from risorius.geometry.normals import vertex_normals
from risorius.geometry.sides import sides_of
from tests.heads import user_head
from tests.sim.poses import advance

from .command_line import risorius

SIZE = (150, 170)
BOTH_STRUCTURES = AnatomyView(STRUCTURES)


@pytest.fixture(scope="module")
def studio() -> Iterator[Capture]:
    """A small multisampled picture of the built-in face."""
    with Capture(FaceScene(), CaptureOptions(size=SIZE)) as opened:
        yield opened


def picture(studio, anatomy, **style):
    """The picture of the face in its current state."""
    options = replace(studio.options, anatomy=anatomy)
    studio.options = replace(options, style=render.Style(**style))
    return studio.draw_image().astype(int)


def posed(scene, **pose):
    """The face, one second after its pose was set."""
    scene.reset()
    scene.pose(pose)
    advance(scene, 60)
    return scene


def structures_of(studio, **pose):
    """Muscles and skull of the face in a pose."""
    posed(studio.scene, **pose)
    parts = [each.part for each in studio.pipeline.anatomy.dissect(BOTH_STRUCTURES).parts]
    return [part for part in parts if part.name.startswith(("skull", "muscles"))]


def check_surface(part):
    """Check that a part is finite and closed, and has unit normals.

    Closed means that each edge is used once in each direction.
    """
    assert np.isfinite(part.vertices).all()
    assert np.isfinite(part.colours).all()
    assert 0.0 <= part.colours.min()
    assert part.colours.max() <= 1.0
    assert np.abs(norm(part.normals, axis=1) - 1.0).max() < 1e-3
    edges = sides_of(part.faces)
    known, count = np.unique(edges, axis=0, return_counts=True)
    often = dict(zip(map(tuple, known.tolist()), count.tolist(), strict=True))
    unpaired = [edge for edge, times in often.items() if often.get(edge[::-1]) != times]
    ends = part.vertices[np.array(unpaired, int).reshape(-1, 2)]  # ends of bands, drawn together
    assert np.abs(ends[:, 0] - ends[:, 1]).max(initial=0.0) < 1e-3


@pytest.mark.slow
def test_skin_that_hides_everything_is_drawn_as_ever(studio):
    """With opacity 1, or without structures, the picture equals one without anatomy."""
    posed(studio.scene)
    usual = picture(studio, AnatomyView())
    assert np.array_equal(picture(studio, AnatomyView(STRUCTURES, 1.0)), usual)
    assert np.array_equal(picture(studio, AnatomyView((), 0.2)), usual)
    assert (picture(studio, BOTH_STRUCTURES) != usual).mean() > 0.3
    assert np.array_equal(picture(studio, AnatomyView()), usual)  # and leaves nothing behind


@pytest.mark.slow
@pytest.mark.parametrize("pose", [{}, {"joy": 1.0}, {"jaw_open": 1.0, "head_yaw": 0.6}])
def test_surfaces_are_sound(studio, pose):
    """Surfaces are valid at rest, in a smile, and in a turned head that yawns."""
    made = structures_of(studio, **pose)
    assert len(made) == 5
    for part in made:
        check_surface(part)


@pytest.mark.slow
def test_muscles_swell_and_redden_as_they_contract():
    """In a smile the zygomaticus is thicker in the middle, and redder, equally on both sides."""
    scene = posed(FaceScene())
    muscles = Muscles.from_face(scene.face)
    names = [name for name, _ in muscles.names]

    def belly(name):
        """The area [mm2] and the redness of the muscle's middle cross section."""
        first = names.index(name) * ROW_COUNT * SECTION_POINTS + ROW_COUNT // 2 * SECTION_POINTS
        ring = muscles.vertices[first : first + SECTION_POINTS].astype(float)
        middle = ring - ring.mean(axis=0)
        area = norm(np.cross(middle, np.roll(middle, -1, axis=0)).sum(axis=0))
        red, green, _ = muscles.colours[first + SECTION_POINTS // 4]
        return 0.5 * float(area), float(red / green)

    at_rest = belly("zygomaticus_major_left")
    muscles.follow(posed(scene, joy=1.0).face)
    left = belly("zygomaticus_major_left")
    right = belly("zygomaticus_major_right")
    assert left[0] > 1.15 * at_rest[0]
    assert left[1] > 1.5 * at_rest[1]
    assert right == approx(left, rel=0.02)
    late = Muscles.from_face(scene.face)  # made during a smile, muscles are the same
    assert np.abs(late.vertices - muscles.vertices).max() < 0.05
    muscles.follow(posed(scene).face)
    assert belly("zygomaticus_major_left") == approx(at_rest, rel=0.01)


@pytest.mark.slow
def test_a_users_head_has_muscles_and_a_skull(tmp_path):
    """A user's head has muscles and a skull inside its skin.

    A long head's skull is long, and the mandible moves down with the jaw.
    """
    head = fit_head(*user_head().write(tmp_path))
    longer = head.vertices * np.where(head.vertices[:, 2:] < 0.0, [1.0, 1.0, 1.25], 1.0)
    scene = FaceScene(replace(head, vertices=longer))
    anatomy = DrawnAnatomy(scene)
    low = scene.rest_positions.min(axis=0)
    high = scene.rest_positions.max(axis=0)
    parts = {each.part.name: each.part for each in anatomy.dissect(BOTH_STRUCTURES).parts}
    for name in ("skull_cranium", "skull_mandible", "skull_nose", "muscles"):
        points = parts[name].vertices
        assert np.isfinite(points).all()
        assert len(points) > 300
        assert (points.max(axis=0) < high + 2.0).all()
        assert (points.min(axis=0) > low - 12.0).all()
    assert parts["skull_cranium"].vertices[:, 2].min() < low[2] + 8.0
    before = parts["muscles"].vertices
    posed(scene, jaw_open=1.0)
    anatomy.dissect(BOTH_STRUCTURES)
    assert (before[:, 1] - parts["muscles"].vertices[:, 1]).max() > 8.0


def test_the_coarse_head_has_muscles_and_a_skull():
    """The coarse head has muscles and a skull, because it has the same anatomical points.

    The throat ends by the edge of the jaw beside it, below which it hung as a dark flap, and in
    front of the spine, of which a vertebra showed through it.
    """
    scene = FaceScene(coarse_head())
    parts = {
        each.part.name: each.part for each in DrawnAnatomy(scene).dissect(BOTH_STRUCTURES).parts
    }
    low = scene.rest_positions.min(axis=0) - 12.0
    high = scene.rest_positions.max(axis=0) + 2.0
    for name in ("skull_cranium", "skull_mandible", "muscles"):
        points = parts[name].vertices
        assert np.isfinite(points).all()
        assert ((low < points) & (points < high)).all()
    _, lowest, back = parts["throat"].vertices.min(axis=0)
    front = parts["throat"].vertices[:, 2].max()
    jaw = parts["skull_mandible"].vertices
    assert lowest > jaw[jaw[:, 2] < front, 1].min() - 4.0
    spine = parts["skull_spine"].vertices
    assert back > spine[spine[:, 1] > lowest, 2].max() + 0.5


@pytest.mark.slow
def test_the_command_draws_anatomy(tmp_path):
    """`--anatomy` opens the given side; an unknown structure is reported in one line."""
    always = ["capture", "--set", "AU12=1", "--size", "120x120", "--quiet"]
    plain = tmp_path / "plain.png"
    opened = tmp_path / "opened.png"

    def run(*more):
        return risorius(*always, *more)

    assert run("-o", str(plain)).exit_code == 0
    message = ("--anatomy", "dissect=left,opacity=0.1")
    assert run(*message, "--head", "ada", "-o", str(opened)).exit_code == 0  # with long hair
    assert run(*message, "-o", str(opened)).exit_code == 0
    first, second = (np.array(Image.open(path)).astype(int) for path in (plain, opened))
    off = np.abs(first - second).max(axis=2) > 24
    assert off[:, 63:].mean() > 5.0 * off[:, :57].mean()
    wrong = run("--anatomy", "muscles,bones", "-o", str(plain))
    assert wrong.exit_code == 2
    assert "muscles, skull" in wrong.output
    dense = run("--anatomy", "opacity=2", "-o", str(plain))
    assert dense.exit_code == 2
    assert "a number from 0 to 1" in dense.output


@pytest.mark.parametrize(("pose", "view"), [({}, "-30,-10,1.3"), ({"surprise": 1.0}, "-12,0,2")])
def test_the_whole_side_is_the_usual_picture(studio, pose, view):
    """The side that is not opened looks as usual: no structure comes through its skin.

    The mouth is lined, and lashes are there.
    """
    posed(studio.scene, **pose)
    camera, studio.camera = studio.camera, camera_for(studio.scene, view)
    usual = picture(studio, AnatomyView(), shadows=False)
    opened = picture(studio, AnatomyView(STRUCTURES, 0.3, "left"), shadows=False)
    shown = np.abs(opened - usual).max(axis=2) > 24
    at_rest = studio.scene.rest_positions
    is_midline = (at_rest[:, 0] == 0.0) & (at_rest[:, 2] > 45.0)  # in front, including the throat
    midline = studio.scene.positions[is_midline]
    edge = int(pixels_of(studio.camera, midline)[:, 0].min()) - 4
    studio.camera = camera
    assert shown[:, :edge].mean() < 0.001
    assert shown.mean() > 0.05


def test_no_locks_of_hair_float_above_the_opened_side(studio):
    """Locks of the whole side begin far enough from the cut that their ends do not pass it."""
    scene = posed(studio.scene)
    middle = float(np.median(scene.rest_positions[:, 0]))
    opened = studio.pipeline.anatomy.dissect(AnatomyView(STRUCTURES, 0.12, "right"))
    locks = [each.part for each in opened.parts if each.part.name == "hair_locks"]
    assert locks
    for part in locks:
        assert len(part.faces) > 1000
        assert part.vertices[part.faces, 0].min() > middle + 5.0


def pixels_of(camera, points):
    """Column and row of points of the world in the picture."""
    matrix = np.asarray(camera.view_matrix()) @ np.asarray(
        camera.projection_matrix(SIZE[0] / SIZE[1])
    )
    clip = np.hstack([points, np.ones((len(points), 1))]) @ matrix
    place = 0.5 * (clip[:, :2] / clip[:, 3:] + 1.0)
    return np.stack([place[:, 0] * SIZE[0], (1.0 - place[:, 1]) * SIZE[1]], axis=1)


def test_a_mask_is_searched_for_a_neck_once(monkeypatch):
    """A head without a neck searches for one once, not in each frame.

    The search takes half a second for a dense scan.
    """
    searched = []

    def no_sections(head):
        """Return no sections, as for a mask."""
        searched.append(head)
        return []

    monkeypatch.setattr("risorius.app.anatomy.neck_sections", no_sections)
    anatomy = DrawnAnatomy(FaceScene())
    for _ in range(2):
        anatomy.dissect(BOTH_STRUCTURES)
    assert len(searched) == 1


@pytest.mark.parametrize("pose", [{"joy": 1.0}, {"jaw_open": 1.0}, {"anger": 1.0}])
def test_bands_move_with_the_skin_and_leave_the_mouth_open(pose):
    """In a suddenly set joy, bands move smoothly with the skin, and leave the open mouth free.

    They once jumped by up to 34 mm in a frame, and crossed the open mouth.
    """
    scene = posed(FaceScene())
    muscles = Muscles.from_face(scene.face)
    scene.pose(pose)
    before = muscles.vertices, scene.positions.copy()
    for _ in range(40):
        scene.step(1.0 / 60.0)
        muscles.follow(scene.face)
        now = muscles.vertices, scene.positions.copy()
        bands, skin = (norm(b - a, axis=1).max() for a, b in zip(before, now, strict=True))
        assert bands < 1.5 * skin + 0.5
        before = now
    inner = scene.positions[scene.landmarks[60:68], :2]  # an octagon, from corner to corner
    x, y = muscles.vertices[:, :2].T
    upper = np.interp(x, *inner[[0, 1, 2, 3, 4]].T)
    lower = np.interp(x, *inner[[0, 7, 6, 5, 4]].T)
    is_across = (lower + 1.0 < y) & (y < upper - 1.0)
    assert not is_across.any()


@pytest.mark.parametrize("pose", [{}, {"AU9": 1.0}, {"AU39": 1.0}])
def test_muscles_of_the_nose_lie_below_its_skin(pose):
    """No part of a muscle across the nose is outside its skin; one lay up to 1.4 mm outside."""
    scene = posed(FaceScene(), **pose)
    face = scene.face
    muscles = Muscles.from_face(face)
    bands = [number for number, (name, _) in enumerate(muscles.names) if "nasalis" in name]
    assert len(bands) >= 4
    points = muscles.vertices.reshape(-1, ROW_COUNT * SECTION_POINTS, 3)[bands].reshape(-1, 3)
    skin = face.simulation.positions
    found = closest_points(points, skin, face.simulation.faces)
    normals = vertex_normals(skin, face.simulation.faces)
    off = points - found.interpolate(skin)
    height = np.einsum("nc,nc->n", off, found.interpolate(normals))
    assert height.max() < 0.0
