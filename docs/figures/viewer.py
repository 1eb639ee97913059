"""Draw the pictures of docs/viewer.md: `xvfb-run -a python docs/figures/viewer.py [FOLDER]`.

Each is a window as a user sees it, in a state set by the commands of menus.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import figures
from imgui_bundle import imgui

from risorius import assets
from risorius.app.capture.drawing import camera_for
from risorius.app.performances import script_for
from risorius.app.pictures import Image
from risorius.app.script.keyframes import all_keys
from risorius.app.viewer import Viewer
from risorius.app.viewer.settings import Display
from risorius.assets.fitting.guess import FIRST_LANDMARKS


def wait_until_settled(viewer: Viewer) -> None:
    """Draw frames until the face is at rest and the picture has full detail."""
    most_frames = 400
    for frame in range(most_frames):
        if frame > 8 and viewer.schedule.is_idle:
            return
        if viewer.messages.is_fading:
            viewer.messages.seconds_left = 0.0
        viewer.frame()


def face(viewer: Viewer) -> None:
    """The window as it opens, smiling."""
    viewer.session.toggle_solo("joy")


def controls(viewer: Viewer) -> None:
    """Search, separate sides, and one active muscle among all."""
    viewer.settings.is_linked = False
    viewer.face.face_panel.search = "upper lip"
    viewer.session.set("levator_labii_superioris_left", 0.9)
    viewer.settings.display.overlays = ["muscles"]


def wipe(viewer: Viewer) -> None:
    """Static and refined, half a face each, divided by a line; the dark theme."""
    viewer.session.toggle_solo("disgust")
    viewer.context.wanted_tab = "Mechanism"
    viewer.settings.theme = "dark"
    # Show the panel's refinement and colours of the mesh.
    viewer.settings.folds |= dict.fromkeys(("Anatomy", "Milliseconds"), False)
    viewer.settings.display = Display(compare="wipe", wireframe=True, splits=True, skin="clay")
    viewer.face.view.camera = camera_for(viewer.session.scene, "front")
    viewer.face.view.camera.zoom(1.08)


def timeline(viewer: Viewer) -> None:
    """Keys of poses and tracks, some of them selected; the dark theme."""
    viewer.settings.theme = "dark"
    viewer.settings.folds["Tracks"] = True
    axis = viewer.face.time_axis
    viewer.session.seek(2.3)
    viewer.frame()
    axis.zoom(0.6, axis.x(0.0))
    viewer.face.selection.keys = all_keys(viewer.session.script).between(1.5, 3.0)


def curves(viewer: Viewer) -> None:
    """Values of controls over time; a key is selected."""
    viewer.settings.shows_curves = True
    viewer.session.seek(3.7)
    viewer.frame()
    viewer.face.time_axis.zoom(0.5, viewer.face.time_axis.x(0.0))
    viewer.face.selection.keys = all_keys(viewer.session.script).between(3.5, 4.0)


def landmarks(viewer: Viewer) -> None:
    """Landmarks of a mesh, guessed from six points: the built-in head as an unknown mesh."""
    head = assets.load("head")
    fine = head.finer(1)
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in fine.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in fine.faces + 1]
    with tempfile.TemporaryDirectory() as folder:
        mesh = Path(folder) / "anna.obj"
        mesh.write_text("\n".join(lines))
        viewer.read(mesh)()
    assert viewer.marking_mode is not None
    marking = viewer.marking_mode.marking
    for number in FIRST_LANDMARKS:
        marking.place(number, marking.placing.points(head.vertices[head.landmarks[number]]))
    marking.note()
    marking.current = 50
    viewer.frame()


def draw_image(stop: Callable[[Viewer], None]) -> Image:
    """A window at a stop of the tour."""
    size = (1160, 700)
    with Viewer(script_for(None, "face"), size) as viewer:
        viewer.settings.is_alive = False  # The picture is the same in every run.
        # The mouse points at nothing, so no hint appears.
        imgui.get_io().config_flags |= imgui.ConfigFlags_.no_mouse
        wait_until_settled(viewer)
        stop(viewer)
        if not viewer.messages.text:
            wait_until_settled(viewer)
        return viewer.surface.read() // 2 * 2  # without noise, see figures.py


if __name__ == "__main__":
    stops = controls, wipe, timeline, curves, landmarks
    named = {"viewer": face, **{f"viewer_{stop.__name__}": stop for stop in stops}}
    figures.run(__doc__, {name: partial(draw_image, stop) for name, stop in named.items()})
