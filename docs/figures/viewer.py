"""Draw the pictures of docs/viewer.md: `xvfb-run -a python docs/figures/viewer.py [FOLDER]`.

Each is a window as a user would see it, brought there by the same commands that menus use.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from imgui_bundle import imgui

from risorius import assets
from risorius.app.cameras import camera_for
from risorius.app.files import Image
from risorius.app.performances import script_for
from risorius.app.script.keyframes import places_of
from risorius.app.viewer import Viewer
from risorius.app.viewer.settings import Display
from risorius.app.viewer.skin_drag import SkinDrag
from risorius.assets.fitting.guess import FIRST
from risorius.bench import figures

SIZE = (1160, 700)
MOST_FRAMES = 400


def wait_until_settled(viewer: Viewer) -> None:
    """Let the face come to rest, and the picture be drawn in full."""
    for _ in range(8):
        viewer.frame()
    for _ in range(MOST_FRAMES):
        if viewer.is_idle:
            return
        viewer.messages.seconds_left = (
            0.0 if viewer.messages.is_fading else viewer.messages.seconds_left
        )
        viewer.frame()


def face(viewer: Viewer) -> None:
    """The window as it opens, smiling."""
    viewer.session.toggle_alone("joy")


def controls(viewer: Viewer) -> None:
    """Search, sides apart, and one muscle at work among all of them."""
    viewer.settings.is_linked = False
    viewer.face_panel.search = "lip"
    viewer.session.set("levator_labii_superioris_left", 0.9)
    viewer.settings.display.overlays = ["muscles"]


def wipe(viewer: Viewer) -> None:
    """Static and refined, half a face each, divided by a line; the dark theme."""
    viewer.session.toggle_alone("disgust")
    viewer.panel_state.wanted_tab, viewer.settings.theme = "Mechanism", "dark"
    viewer.settings.folds["Overlays"] = False  # or the plots below it would be cut off
    viewer.settings.display = Display(compare="wipe", wireframe=True, colours="splits", skin="clay")
    viewer.view.camera = camera_for(viewer.session.scene, "front")
    viewer.view.camera.zoom(1.08)


def side_by_side(viewer: Viewer) -> None:
    """Two viewports under one camera, coloured by how far the normals turned apart."""
    viewer.session.toggle_alone("joy")
    viewer.panel_state.wanted_tab = "Mechanism"
    viewer.settings.folds["Overlays"] = False  # or the plots below it would be cut off
    viewer.settings.display = Display(compare="side by side", colours="curvature drop", skin="clay")


def tension(viewer: Viewer) -> None:
    """What is stretched and what is compressed, with the springs."""
    viewer.session.toggle_alone("yawn")
    viewer.panel_state.wanted_tab = "Mechanism"
    viewer.settings.display = Display(colours="tension", overlays=["springs"], skin="clay")


def anatomy(viewer: Viewer) -> None:
    """Skull, muscles and landmarks."""
    viewer.session.set("jaw_open", 0.5)
    viewer.panel_state.wanted_tab, viewer.settings.theme = "Mechanism", "dark"
    viewer.settings.display = Display(overlays=["skull", "muscles"], dissect="left")
    viewer.view.camera = camera_for(viewer.session.scene, "three-quarter")


def finger(viewer: Viewer) -> None:
    """The skin, dragged by the mouse."""
    scene = viewer.session.scene
    corner = scene.positions[scene.head.landmarks[48]]  # type: ignore[attr-defined]
    sight = np.array([0.0, 0.0, -1.0])
    viewer.mouse.skin_drag = SkinDrag(viewer.session, viewer.settings, corner.copy(), sight, True)
    viewer.mouse.skin_drag.to(corner + np.array([-20.0, 11.0, 8.0]))
    for _ in range(20):
        viewer.frame()
    viewer.painter.level_of_detail.level = 0
    viewer.frame()


def timeline(viewer: Viewer) -> None:
    """Keys of poses and tracks, some of them selected; the dark theme."""
    viewer.settings.theme, viewer.settings.folds["Tracks"] = "dark", True
    axis = viewer.time_axis
    viewer.session.seek(2.3)
    viewer.frame()
    axis.zoom(0.6, axis.x(0.0))
    viewer.selection.places = places_of(viewer.session.script).between(1.5, 3.0)


def keys(viewer: Viewer) -> None:
    """Help, made of the same table as the menus."""
    viewer.panel_state.is_help_open = True


def unsaved(viewer: Viewer) -> None:
    """A question before work is lost."""
    viewer.session.set("jaw_open", 0.4)
    viewer.ask_to_close()


def large(viewer: Viewer) -> None:
    """Everything as on a screen of twice the density."""
    viewer.settings.zoom = 2.0
    viewer.session.toggle_alone("kiss")


def landmarks(viewer: Viewer) -> None:
    """Landmarks of a mesh, guessed from five points: the built-in head, as if it was foreign."""
    head = assets.load("head")
    fine = head.finer(1)
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in fine.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in fine.faces + 1]
    with tempfile.TemporaryDirectory() as folder:
        mesh = Path(folder) / "anna.obj"
        mesh.write_text("\n".join(lines))
        viewer.mark(mesh)
    assert viewer.room is not None
    marking = viewer.room.marking
    for number in FIRST:
        marking.put(number, marking.placing.points(head.vertices[head.landmarks[number]]))
    marking.note()
    marking.current = 50
    viewer.frame()


STOPS: dict[str, Callable[[Viewer], None]] = {
    "viewer": face,
    "viewer_controls": controls,
    "viewer_wipe": wipe,
    "viewer_side_by_side": side_by_side,
    "viewer_tension": tension,
    "viewer_anatomy": anatomy,
    "viewer_pull": finger,
    "viewer_timeline": timeline,
    "viewer_keys": keys,
    "viewer_unsaved": unsaved,
    "viewer_large": large,
    "viewer_landmarks": landmarks,
}


def draw_image(stop: Callable[[Viewer], None]) -> Image:
    """A window, brought to a stop of the tour."""
    with Viewer(script_for(None, "face"), SIZE) as viewer:
        viewer.settings.is_alive = False  # the same picture every time
        # Wherever the mouse happens to be, it points at nothing: no hint comes up.
        imgui.get_io().config_flags |= imgui.ConfigFlags_.no_mouse
        wait_until_settled(viewer)
        stop(viewer)
        if viewer.mouse.skin_drag is None:
            wait_until_settled(viewer)
        return figures.without_noise(viewer.surface.read())


def main(arguments: Sequence[str]) -> None:
    """Draw the pictures into the folder given."""
    given = figures.parse(arguments, __doc__)
    every = {name: partial(draw_image, stop) for name, stop in STOPS.items()}
    figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
