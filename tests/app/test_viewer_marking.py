"""Marking of the 68 landmarks of a mesh: by clicks in the window, and without one."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.linalg import norm
from PIL import Image
from pytest import approx

from risorius.__main__ import command
from risorius.app.cli import commands
from risorius.app.cli.commands import fitted_head_of
from risorius.app.errors import UserError
from risorius.app.viewer import Viewer
from risorius.app.viewer.documents.file_dialogs import FileDialogs
from risorius.app.viewer.marking import Marking
from risorius.app.viewer.marking.marking import FIRST_LANDMARKS, MARKING_ORDER
from risorius.app.viewer.marking.picture import places_in
from risorius.assets import AssetError
from risorius.assets.fitting.guess import placing
from risorius.assets.fitting.landmark_file import read_landmarks
from tests.heads import METRES_PER_MILLIMETRE, user_head, with_card, write_topology

from .driving import (
    NEEDS_A_SCREEN,
    click,
    drop,
    on_screen,
    press_keys,
    settle,
    until,
    write,
    xdotool,
)

GUESS_ERROR = 6.0 * METRES_PER_MILLIMETRE  # [m], error of guesses on the built-in head's shape


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    """A head in metres, with z up."""
    return user_head().write(tmp_path)[0]


@pytest.fixture
def marking(mesh: Path) -> Marking:
    """The marking of the mesh, still empty."""
    return Marking(mesh, FileDialogs())


def true_places():
    """The places of its landmarks."""
    other = user_head()
    return other.mesh.vertices[other.landmarks]


def mark_first(marking):
    """Place the first six landmarks exactly, in the order of the questions."""
    for number in FIRST_LANDMARKS:
        assert marking.current == number
        marking.place(number, marking.placing.points(true_places()[number]))
        marking.note()


def off(marking):
    """Distances of marks from their true places [m]."""
    found = np.array([marking.marks.places[number] for number in range(68)])
    return norm(found - true_places(), axis=1)


def test_a_known_head_opens_without_marking(mesh, tmp_path, monkeypatch):
    """`view --head MESH` fits a known head; if its landmarks do not fit, marking opens."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    opened = []
    monkeypatch.setattr(commands, "open_window", lambda *given, **_: opened.append(given))
    assert CliRunner().invoke(commands.view, ["--head", str(mesh)]).exit_code == 0
    drawing = opened[0][2]
    assert fitted_head_of(drawing, may_be_marked=True) == (None, "")
    write_topology(tmp_path, user_head())
    head, complaint = fitted_head_of(drawing, may_be_marked=True)
    assert head.files == (mesh,) and not complaint
    write_topology(tmp_path, user_head(), landmarks=list(range(68)))
    head, complaint = fitted_head_of(drawing, may_be_marked=True)
    assert head is None and "those of mine" in complaint
    with pytest.raises(AssetError, match="those of mine"):
        fitted_head_of(drawing, may_be_marked=False)


def test_a_landmark_off_the_mesh_is_marked_anew(mesh, tmp_path, monkeypatch):
    """`view --head MESH --landmarks FILE` opens the marking if a landmark lies off the mesh."""
    opened = []
    monkeypatch.setattr(
        commands, "open_window", lambda *given, **more: opened.append((given, more))
    )
    points = true_places()
    points[30] += 0.1 * (points[30] - points[[1, 15]].mean(axis=0))
    file = tmp_path / "off.json"
    file.write_text(json.dumps(points.tolist()))
    given = ["--head", str(mesh), "--landmarks", str(file)]
    assert CliRunner().invoke(commands.view, given).exit_code == 0
    (_, _, drawing), more = opened[0]
    assert more["mesh"] == mesh
    head, complaint = fitted_head_of(drawing, may_be_marked=True)
    assert head is None and "mark 30 anew" in complaint


@pytest.mark.slow
def test_half_done_marks_are_kept_and_continued(marking, tmp_path):
    """Unmarked landmarks are saved as null; marking continues from such a file.

    `--landmarks` refuses it.
    """
    target = tmp_path / "half.json"
    for number in FIRST_LANDMARKS[:3]:
        marking.place(number, marking.placing.points(true_places()[number]))
        marking.note()
    assert marking.unsaved
    marking.file = target
    marking.save()
    assert not marking.unsaved
    assert json.loads(target.read_text())["landmarks"].count(None) == 65
    with pytest.raises(AssetError, match="65 of 68"):
        read_landmarks(target, marking.mesh)
    again = Marking(marking.path, FileDialogs())
    again.open(target)
    assert again.marks == marking.marks
    assert again.current == FIRST_LANDMARKS[3]
    assert not again.unsaved
    for number in FIRST_LANDMARKS[3:]:
        again.place(number, again.placing.points(true_places()[number]))
        again.note()
    again.save()
    third = Marking(marking.path, FileDialogs())
    third.open(target)
    assert third.marks == again.marks and third.is_upright  # guessed points stay guessed
    third.undo()
    assert not third.marks.places and not third.is_upright  # the head may be turned again
    third.undo(-1)
    assert third.marks == again.marks
    assert third.is_upright


def test_vertex_indices_can_be_corrected(marking, tmp_path):
    """A landmark file of another program is read, and saved as points."""
    _, numbers = user_head().write(tmp_path)
    marking.open(numbers)
    assert off(marking).max() < 1e-8
    assert not marking.marks.guessed
    wrong = Marking(marking.path, FileDialogs())
    numbers.write_text(json.dumps({"landmarks": np.roll(user_head().landmarks, 20).tolist()}))
    with pytest.raises(UserError, match=r"\.json: these points form no face"):
        wrong.open(numbers)
    assert not wrong.marks.places
    assert wrong.file is None
    numbers.write_text('{"landmarks": [1, 2]}')
    with pytest.raises(UserError, match="68 iBug points"):
        marking.open(numbers)
    assert marking.marks.is_complete


def test_a_mesh_that_can_be_no_head_is_refused_at_once(tmp_path):
    """A mesh that cannot be a head is refused before the user marks 68 points."""
    mesh = tmp_path / "fan.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 2 0\nv 0 3 1\nf 1 2 3\nf 1 2 4\nf 2 1 5\n")
    with pytest.raises(UserError, match=r"fan\.obj: the mesh is not manifold"):
        Marking(mesh, FileDialogs())


def test_pieces_beside_the_skin_may_be_anything(tmp_path):
    """A card of hair without a valid surface does not prevent marking of the skin."""
    other = user_head()
    mesh = with_card(other.mesh)
    path, _ = other.write(tmp_path, vertices=mesh.vertices, faces=mesh.faces)
    assert len(Marking(path, FileDialogs()).seen_mesh.faces) == len(mesh.faces)


class TestInTheWindow:
    """Tests with real events."""

    pytestmark: ClassVar = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]

    @pytest.fixture(autouse=True)
    def back(self, viewer: Viewer) -> Iterator[None]:
        """Restore the window."""
        before = viewer.session.scene
        yield
        viewer.context.question.task = None
        viewer.leave_marking()
        if viewer.session.scene is not before:
            viewer.show_scene(before)
        viewer.surface.should_close = viewer.is_leaving = False

    def mode(self, viewer):
        """The marking mode of the window."""
        assert until(viewer, lambda: viewer.marking_mode is not None)
        assert viewer.marking_mode is not None
        return viewer.marking_mode

    def place(self, viewer, point):
        """Screen coordinates of a point of the mesh."""
        mode = self.mode(viewer)
        seen = mode.marking.placing.points(point[None])
        return on_screen(viewer, *places_in(mode.view.area, mode.view.camera, seen)[0])

    def face_it(self, viewer):
        """Turn the camera to the face, which lies on its back, because its file has z up."""
        mode = self.mode(viewer)
        settle(viewer)  # the mesh is placed in the window
        front = placing(dict(enumerate(true_places()))).inverse.vectors([0.0, 0.0, 1.0])
        x, y, z = mode.marking.placing.vectors(front)
        camera = mode.view.camera
        camera.orbit(math.degrees(math.atan2(x, z)) - camera.yaw)
        camera.orbit(0.0, math.degrees(math.atan2(y, math.hypot(x, z))) - camera.pitch)

    def mark_first(self, viewer):
        """Click the first points."""
        self.face_it(viewer)
        for number in FIRST_LANDMARKS:
            assert self.mode(viewer).marking.current == number
            xdotool(viewer, "mousemove", *self.place(viewer, true_places()[number]))
            xdotool(viewer, "click", 1)
        assert until(viewer, lambda: self.mode(viewer).marking.marks.is_complete)

    def test_a_head_is_put_upright_before_anything_is_marked(self, viewer, mesh):
        """A head with z up is turned by the mouse and a button; each turn can be undone."""
        drop(viewer, mesh)
        marking = self.mode(viewer).marking
        self.face_it(viewer)
        ways = placing(dict(enumerate(true_places()))).inverse.vectors(np.eye(3))

        def axes():
            """Directions to the left, up and out of the face, in the view."""
            turned = marking.placing.vectors(ways)
            return turned / norm(turned, axis=1, keepdims=True)

        lying = axes()
        click(viewer, "Turn")
        assert axes()[2] == approx([0.0, 0.0, 1.0], abs=0.1)
        up = axes()[1]
        click(viewer, "Turn")
        assert axes()[1] == approx([up[1], -up[0], 0.0], abs=0.1)  # clockwise
        press_keys(viewer, "ctrl+z", "ctrl+z")
        assert axes() == approx(lying)
        press_keys(viewer, "ctrl+y")
        while axes()[1, 1] < 0.9:
            press_keys(viewer, "t")
        assert axes() == approx(np.eye(3), abs=0.1)

    def test_a_mark_is_put_only_where_it_is_seen(self, viewer, mesh):
        """A click through the open neck on the back of skin makes no mark; a line reports it."""
        viewer.read(mesh)()
        mode = self.mode(viewer)
        mode.view.camera.orbit(180.0)
        settle(viewer)
        left, top, width, height = mode.view.area
        place = on_screen(viewer, left + 0.5 * width, top + 0.5 * height)
        xdotool(viewer, "mousemove", *place, "click", 1)
        assert not mode.marking.marks.places
        assert "There is no skin here" in viewer.messages.text

    def test_a_head_is_marked_from_the_first_click_to_the_picture(self, viewer, mesh, tmp_path):
        """A head is marked by a drop, six clicks, a drag, undo and save; capture draws it."""
        drop(viewer, mesh)
        marking = self.mode(viewer).marking
        self.mark_first(viewer)
        assert np.median(off(marking)) < 2.0 * METRES_PER_MILLIMETRE
        assert off(marking).max() < 2.0 * GUESS_ERROR
        before = marking.marks
        number = 37
        start = self.place(viewer, np.array(before.places[number]))
        xdotool(viewer, "mousemove", *start)
        xdotool(viewer, "mousedown", 1)
        xdotool(viewer, "mousemove_relative", "--", 2, -12)
        xdotool(viewer, "mousemove_relative", "--", 2, -8)
        xdotool(viewer, "mouseup", 1)
        moved = np.subtract(marking.marks.places[number], before.places[number])
        assert norm(moved) > 2.0 * METRES_PER_MILLIMETRE
        assert marking.current == number
        assert [n for n in MARKING_ORDER if marking.marks.places[n] != before.places[n]] == [number]
        press_keys(viewer, "ctrl+z")
        assert marking.marks == before
        press_keys(viewer, "ctrl+y")
        assert number in marking.marks.by_hand
        press_keys(viewer, "Right")
        assert marking.current == MARKING_ORDER[MARKING_ORDER.index(number) + 1]
        self.mode(viewer).view.camera.orbit(80.0, 0.0)  # hidden in this side view
        press_keys(viewer, "Left")
        settle(viewer)
        assert number == marking.current
        assert number in self.mode(viewer).view.places()
        click(viewer, "Use this head")
        assert viewer.files.is_waiting
        press_keys(viewer, "ctrl+a")
        write(viewer, "marked")
        press_keys(viewer, "Return")
        assert until(viewer, lambda: viewer.marking_mode is None)
        assert len(viewer.session.scene.faces) == len(user_head().mesh.faces)
        image = tmp_path / "joy.png"
        marks = mesh.with_name("marked.json")
        assert viewer.exporter.head.files == (mesh, marks)  # ready for an avatar
        options = ("--set", "joy", "--size", "160x160", "-o", image)
        words = ("capture", "--head", mesh, "--landmarks", marks, *options)
        result = CliRunner().invoke(command(), [str(word) for word in words])
        assert result.exit_code == 0, result.output
        assert np.asarray(Image.open(image)).std() > 10.0

    @pytest.mark.slow
    def test_marks_are_not_lost_without_a_question(self, viewer, mesh):
        """Leaving, closing and a second mesh ask before marks are lost; Save continues."""
        viewer.session.set("jaw_open", 0.5)
        viewer.read(mesh)()
        press_keys(viewer, "ctrl+w")
        assert viewer.marking_mode is None  # nothing was marked, and the pose is kept
        viewer.read(mesh)()
        self.mark_first(viewer)
        mode = viewer.marking_mode
        click(viewer, "Leave")
        assert viewer.context.question.is_open
        assert "question: Save pose ..." not in viewer.gui.places
        press_keys(viewer, "Escape")
        assert viewer.marking_mode is mode
        viewer.drop([str(mesh)])
        assert viewer.context.question.is_open
        press_keys(viewer, "Escape")
        press_keys(viewer, "ctrl+q")
        assert viewer.context.question.unsaved == "the landmarks of user_head.obj"
        press_keys(viewer, "Escape")
        click(viewer, "Leave")
        click(viewer, "question: Save landmarks")
        write(viewer, "")
        press_keys(viewer, "ctrl+a")
        write(viewer, "kept")
        press_keys(viewer, "Return")
        assert until(viewer, lambda: viewer.marking_mode is None)
        assert mesh.with_name("kept.json").exists()
        assert viewer.session.values["jaw_open"] == 0.5
