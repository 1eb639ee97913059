"""The window, driven by real mouse and key events: sliders, skin, picture, questions."""

import ctypes
import subprocess
import sys
from copy import deepcopy

import numpy as np
import pytest
from imgui_bundle import imgui
from pytest import approx

from risorius.app.viewer.picture.highlights import pointed_lines

from .driving import (
    NEEDS_A_SCREEN,
    SIZE,
    clear_search,
    click,
    drag,
    drag_and_release,
    middle,
    moved,
    nose,
    on_screen,
    press_keys,
    seen_at,
    settle,
    show_controls,
    until,
    write,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def test_a_slider_moves_the_skin_and_undo_moves_it_back(viewer):
    """Search for the jaw and drag its slider: vertices move; Ctrl+Z closes the mouth."""
    show_controls(viewer, "jaw open")
    drag_and_release(viewer, middle(viewer, "jaw_open"), (60, 0))
    clear_search(viewer)
    assert viewer.session.values["jaw_open"] > 0.4
    assert until(viewer, lambda: moved(viewer) > 8.0)
    press_keys(viewer, "ctrl+z")
    assert viewer.session.values["jaw_open"] == 0.0
    assert until(viewer, lambda: moved(viewer) < 1.0)
    press_keys(viewer, "ctrl+shift+z")
    assert viewer.session.values["jaw_open"] > 0.4


@pytest.mark.parametrize("has_entered", [True, False])
def test_a_drag_counts_where_it_was_when_the_window_was_busy(viewer, has_entered):
    """While the window is busy, a bar is dragged and the mouse goes elsewhere: the bar is set.

    The mouse may have been over the window when it opened, so that it was not seen to enter.
    """
    show_controls(viewer, "jaw open")
    address = ctypes.cast(viewer.surface.handle, ctypes.c_void_p).value
    if not has_entered:
        imgui.backends.glfw_cursor_enter_callback(address, 0)
    x, y = middle(viewer, "jaw_open")
    bar = ("mousemove", x, y, "mousedown", 1, "mousemove", x + 20, y, "mousemove", x + 60, y)
    try:
        xdotool(viewer, *bar, "mouseup", 1, "mousemove", *nose(viewer))
    finally:
        imgui.backends.glfw_cursor_enter_callback(address, 1)
    clear_search(viewer)
    assert viewer.session.values["jaw_open"] > 0.4


def test_a_number_can_be_typed(viewer):
    """A double click turns a slider into a text field; its menu resets it to 0."""
    show_controls(viewer, "jaw open")
    click(viewer, "jaw_open", times=2)
    press_keys(viewer, "ctrl+a")
    write(viewer, "0.37")
    press_keys(viewer, "Return")
    assert viewer.session.values["jaw_open"] == approx(0.37)
    xdotool(viewer, "mousemove", *middle(viewer, "jaw_open"))
    xdotool(viewer, "click", 3)
    click(viewer, "control menu: Reset to 0")
    assert viewer.session.values["jaw_open"] == 0.0
    clear_search(viewer)


def test_linked_sides_move_together(viewer):
    """One slider sets both linked sides; unlinked, each side has its own slider."""
    session = viewer.session
    show_controls(viewer, "zygom maj")
    left = "zygomaticus_major_left"
    right = "zygomaticus_major_right"
    drag_and_release(viewer, middle(viewer, left), (30, 0))
    assert session.values[left] == session.values[right] > 0.1
    click(viewer, "Link sides")
    drag_and_release(viewer, middle(viewer, right), (-60, 0))
    click(viewer, "Link sides")
    clear_search(viewer)
    assert session.values[right] == 0.0 < session.values[left]


def test_keys_show_expressions_and_refinement(viewer):
    """1 shows the first expression, 1 again the neutral face; R switches refinement."""
    press_keys(viewer, "1")
    assert viewer.session.is_solo(next(iter(viewer.session.scene.expressions)))
    assert until(viewer, lambda: moved(viewer) > 3.0)
    assert until(viewer, lambda: viewer.context.stage.refined.triangle_count > 2100)
    press_keys(viewer, "r")
    shot = viewer.context.stage.viewports(viewer.settings.display, viewer.face.view.viewport)[0]
    assert shot.drawn.triangle_count == len(viewer.session.scene.faces)
    press_keys(viewer, "r")
    press_keys(viewer, "1")
    assert until(viewer, lambda: moved(viewer) < 0.5)


def test_keys_change_the_picture(viewer):
    """W, C, T, D and F2 (for the theme) change the picture, and change it back."""
    viewer.session.toggle_solo("disgust")
    settle(viewer)
    assert until(viewer, lambda: viewer.schedule.is_idle)
    before = viewer.surface.read()
    settings = deepcopy(viewer.settings)
    left = round(viewer.face.view.area[0])
    for key in ("w", "c", "t", "d", "F2"):
        press_keys(viewer, key)
        changed = viewer.surface.read()[:500, left:].astype(int) - before[:500, left:]
        assert np.abs(changed).max() > 20, key
        press_keys(viewer, key)
        assert viewer.settings == settings, key
    assert until(viewer, lambda: viewer.schedule.is_idle)
    back = viewer.surface.read()[:500, left:].astype(int) - before[:500, left:]
    assert np.abs(back).mean() < 0.5


def test_the_mouse_orbits_and_the_wheel_zooms(viewer):
    """The right button orbits from anywhere, the left button beside the face.

    F frames the face.
    """
    view = viewer.face.view.camera.view_matrix().copy()
    for button, place in ((3, nose(viewer)), (1, on_screen(viewer, SIZE[0] - 20, 100))):
        drag_and_release(viewer, place, (-80, 20), button=button)
        turned = viewer.face.view.camera.view_matrix().copy()
        assert np.abs(turned - view).max() > 0.1
        press_keys(viewer, "f")
        assert np.allclose(viewer.face.view.camera.view_matrix(), view)


@pytest.mark.parametrize(
    "number",
    [
        30,
        pytest.param(54, marks=pytest.mark.slow),
        pytest.param(19, marks=pytest.mark.slow),
        -1,
    ],
)
def test_the_wheel_zooms_to_the_mouse(viewer, number):
    """The point below the mouse, on skin or beside it, stays there while zooming in and out."""
    camera = viewer.face.view.camera
    scene = viewer.session.scene
    camera.orbit(20.0, -10.0)
    point = camera.target + 150.0 * camera.axes()[0] + 90.0 * camera.axes()[1]
    if number >= 0:
        point = scene.positions[scene.head.landmarks[number]]
    view = camera.view_matrix().copy()
    place = seen_at(viewer, point)
    xdotool(viewer, "mousemove", *place)
    for button in (4, 5, 5, 4):
        xdotool(viewer, "click", "--repeat", 6, button)
        assert np.abs(np.subtract(seen_at(viewer, point), place)).max() <= 2
    assert np.allclose(camera.view_matrix(), view, atol=1e-3)


def test_the_skin_is_dragged_and_swings_back(viewer):
    """Ctrl and a drag move the tip of the nose; released, it swings back soon."""
    xdotool(viewer, "keydown", "ctrl")
    drag(viewer, nose(viewer), (40, 30))
    assert until(viewer, lambda: moved(viewer) > 4.0)
    xdotool(viewer, "mouseup", 1, "keyup", "ctrl")
    assert until(viewer, lambda: moved(viewer) < 0.3)
    assert not viewer.session.work.unsaved


def test_a_hovered_expression_lights_its_muscles(viewer):
    """Pointing at joy highlights muscles of both sides, at a kiss only those of the lips.

    Muscles with smaller weights are fainter.
    """
    xdotool(viewer, "mousemove", *middle(viewer, "show joy"))
    pulled = [f"{SMILE_MUSCLE}_{side}" for side in ("left", "right")]
    assert until(viewer, lambda: pulled[0] in viewer.face.view.pointed)
    assert viewer.face.view.pointed[pulled[0]] == viewer.face.view.pointed[pulled[1]] > 0.8
    scene = viewer.session.scene
    opacities = [lines.opacity for lines in pointed_lines(scene, viewer.face.view.pointed)]
    assert max(opacities) > 0.8 > min(opacities)
    xdotool(viewer, "mousemove", *middle(viewer, "show kiss"))
    assert until(viewer, lambda: "orbicularis_oris_sphincter" in viewer.face.view.pointed)
    drawn = pointed_lines(scene, viewer.face.view.pointed)
    brows = scene.rest_positions[scene.head.landmarks[27], 1]
    points = np.concatenate([line for lines in drawn for line in lines.polylines])
    assert len(drawn) >= 6
    assert points[:, 1].max() < brows
    xdotool(viewer, "mousemove", *on_screen(viewer, 880, 300))
    assert until(viewer, lambda: not viewer.face.view.pointed)


def test_a_look_is_chosen(viewer):
    """A look is chosen in the panel, by menu and by key; it resets options of the last look."""
    viewer.session.toggle_solo("disgust")
    click(viewer, "tab Mechanism")
    display = viewer.settings.display
    stage = viewer.context.stage
    assert until(viewer, lambda: viewer.schedule.is_idle)
    smooth = stage.refined.triangle_count
    click(viewer, "Look")
    click(viewer, "Look: paper")
    assert display.look == stage.refined.label == "paper"
    paper = stage.refined.triangle_count
    assert len(stage.scene.faces) < paper < 0.8 * smooth
    click(viewer, "Advanced")
    click(viewer, "Refiner")
    click(viewer, "Refiner: loop")
    click(viewer, "Advanced")
    display.options["loop"] = {"levels": 2}
    settle(viewer)
    assert stage.refined.label == "loop, changed"
    assert stage.refined.triangle_count == 16 * len(stage.scene.faces)
    click(viewer, "Look")
    click(viewer, "Look: paper")
    assert stage.refined.triangle_count == paper
    assert stage.refined.label == "paper"
    press_keys(viewer, "p")
    assert display.look == stage.refined.label == "smooth"
    assert stage.refined.triangle_count == smooth
    click(viewer, "menu View")
    click(viewer, "menu View: Paper's look")
    assert display.look == "paper"
    assert stage.refined.triangle_count == paper
    assert not viewer.messages.is_error


def test_closing_asks_about_unsaved_work(viewer):
    """Closing asks about a pose set by hand: "back" keeps the pose, "on" closes."""
    viewer.session.set("jaw_open", 0.5)
    press_keys(viewer, "ctrl+q")
    assert viewer.context.question.is_open
    assert not viewer.surface.should_close
    click(viewer, "question: Back")
    assert not viewer.context.question.is_open
    assert viewer.session.values["jaw_open"] == 0.5
    press_keys(viewer, "ctrl+q")
    click(viewer, "question: Close without saving")
    assert viewer.surface.should_close
    viewer.surface.should_close = viewer.is_leaving = False


def test_an_idle_window_rests(viewer):
    """Without input, neither physics nor the scene is computed."""
    assert until(viewer, lambda: viewer.schedule.is_idle)
    times = {name: list(column) for name, column in viewer.context.times.milliseconds.items()}
    settle(viewer)
    assert times == {
        name: list(column) for name, column in viewer.context.times.milliseconds.items()
    }


SMILE_MUSCLE = "zygomaticus_major"


def landmark(viewer, number):
    """Screen coordinates of a landmark."""
    scene = viewer.session.scene
    return seen_at(viewer, scene.positions[scene.head.landmarks[number]])


def test_pulled_skin_stays_where_muscles_hold_it(viewer):
    """The left corner of the mouth, pulled up and out, stays there; Ctrl+Z undoes the pull."""
    session = viewer.session
    viewer.settings.is_linked = False
    seen = [session.scene.positions.copy()]

    def is_held():
        seen.append(session.scene.positions.copy())
        last_step = np.abs(seen[-1] - seen[-2]).max()
        return moved(viewer) > 1.0 and last_step < 1e-3

    drag(viewer, landmark(viewer, 54), (12, -14))
    assert until(viewer, is_held)
    solved = dict(session.values)
    xdotool(viewer, "mouseup", 1)
    assert session.values == solved
    assert solved[f"{SMILE_MUSCLE}_left"] > 0.3
    assert len([name for name, value in solved.items() if value]) <= 4
    assert not any(value for name, value in solved.items() if name.endswith("_right"))
    assert viewer.messages.text.startswith("Smile muscle, left ")
    assert viewer.messages.text.endswith("mm short of the mouse")
    assert until(viewer, lambda: viewer.face.physics.is_at_rest)
    assert moved(viewer) > 4.0
    assert np.abs(session.scene.positions - seen[-1]).max() < 0.1
    assert session.values == solved
    press_keys(viewer, "ctrl+z")
    assert not any(session.values.values())
    assert until(viewer, lambda: moved(viewer) < 0.3)


def pulled_corner(viewer, by, steps):
    """Pull a corner of the mouth up and out in some steps, release, undo; return the muscles."""
    session = viewer.session
    xdotool(viewer, "mousemove", *landmark(viewer, 54), "mousedown", 1)
    for _ in range(steps):
        xdotool(viewer, "mousemove_relative", "--", by // steps, -by // steps)
    if steps > 1:
        viewer.messages.seconds_left = 0.01
        settle(viewer)
        assert viewer.messages.text.startswith("Smile muscle")
    xdotool(viewer, "mouseup", 1)
    found = {name: value for name, value in session.values.items() if value}
    press_keys(viewer, "ctrl+z")
    assert until(viewer, lambda: moved(viewer) < 0.05)
    return found


def test_a_corner_drawn_up_and_out_smiles_at_any_speed(viewer):
    """Slow or at once, near or far, the same muscle smiles; its name is shown during the drag."""
    found = [pulled_corner(viewer, 60, steps) for steps in (6, 1, 1)]
    assert found[0].keys() == {f"{SMILE_MUSCLE}_left", f"{SMILE_MUSCLE}_right"}
    assert min(found[0].values()) > 0.9
    for other in found[1:]:
        assert other == approx(found[0], abs=0.05)


@pytest.mark.slow
def test_a_pull_is_the_same_beside_busy_processes(viewer):
    """Beside busy processes, muscles move as far as on an idle machine; a far pull is a smile.

    Pulls are short and far, slow and sudden.
    """
    near = 6  # [pixels]: a farther pull is a whole smile
    far = pulled_corner(viewer, 60, 6)
    quiet = pulled_corner(viewer, near, 6)
    assert 0.2 < max(quiet.values()) < 0.95
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        found = [pulled_corner(viewer, near, steps) for steps in (6, 1, 1)]
        smiles = [pulled_corner(viewer, 60, steps) for steps in (6, 1)]
    finally:
        for process in busy:
            process.kill()
            process.wait()
    for other in found:
        assert other == approx(quiet, abs=0.05)
    for smile in smiles:
        assert smile.keys() == {f"{SMILE_MUSCLE}_left", f"{SMILE_MUSCLE}_right"}
        assert smile == approx(far, abs=0.05)


def test_the_muscle_under_the_mouse_shows_softly(viewer):
    """The muscle below the mouse and the skin that it moves light up, but not in files.

    Beside the skin nothing lights up.
    """
    view = viewer.face.view
    stage = viewer.context.stage
    plain = stage.draw_image(view)
    dark = viewer.surface.read_scene(3).astype(int)
    xdotool(viewer, "mousemove", *landmark(viewer, 54))
    assert until(viewer, lambda: view.hovered is not None)
    assert view.hovered.name.endswith("_left")
    scene = viewer.session.scene
    side = scene.positions[:, 0] - scene.framing.focus[0]
    assert side[view.hovered.shares > 0.5].min() > 0.0
    assert (stage.draw_image(view) == plain).all()
    stage.draw(view)
    redness = viewer.surface.read_scene(3).astype(int) - dark
    lit = redness[..., 0] - redness[..., 2] > 20
    assert 500 < lit.sum() < 0.1 * lit.size
    xdotool(viewer, "mousemove", *on_screen(viewer, 880, 300))
    assert until(viewer, lambda: view.hovered is None)


def test_a_click_shows_the_muscle_in_the_panel(viewer):
    """A click opens the muscle's group, and scrolls the panel to its slider."""
    viewer.context.wanted_tab = "Live"
    x, y = landmark(viewer, 54)
    xdotool(viewer, "mousemove", x + 15, y - 15, "click", 1)
    assert until(viewer, lambda: viewer.settings.folds.get("Upper lip and cheek", False))
    assert until(viewer, lambda: "search" in viewer.gui.places)
