"""What menus, keys and panels can ask of the window, beyond its session."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from risorius import render

from ..cameras import whole_scene
from ..files import save_png
from ..script import is_pose
from .setting_rules import ZOOMS
from .settings import save_settings
from .take import Film, free_name

if TYPE_CHECKING:
    from .window import Viewer


# Files


def open_file(viewer: Viewer) -> None:
    """Ask for a script or a pose, and show it."""
    viewer.files.ask("Open script or pose", lambda path: load(viewer, path), saving=False)


def load(viewer: Viewer, path: Path, remark: str = "") -> None:
    """Show the script or pose of a file, unless work would be lost: then ask first.

    remark: what else there is to say when it is opened.
    """
    script = viewer.session.read(path)

    def take() -> None:
        viewer.session.take(script)
        viewer.messages.say(f"{path.name}: opened{remark}")

    if is_pose(script) and not viewer.session.has_unsaved_pose:
        take()  # whatever else is unsaved stays
    else:
        viewer.question.before(viewer, "Open", take)


def _nothing() -> None:
    """After saving, nothing else."""


def new_script(viewer: Viewer) -> None:
    """Begin with an empty script, unless work would be lost: then ask first."""

    def begin() -> None:
        viewer.session.begin_script()
        viewer.messages.say("a new script; K makes the face as it is a key")

    viewer.question.before(viewer, "Begin", begin)


def save_script(viewer: Viewer, then: Callable[[], None] = _nothing) -> None:
    """Write the script to its own file, or ask for one, and go on with `then`."""
    file = viewer.session.file
    if file.path is None:
        save_script_as(viewer, then)
    elif objection := file.objection:
        viewer.messages.say(f"{file.path.name}: {objection}; replace it, or choose another name")
        save_script_as(viewer, then)
    else:
        _write_script(viewer, file.path, then)


def save_script_as(viewer: Viewer, then: Callable[[], None] = _nothing) -> None:
    """Ask for a name, write the script, and go on with `then`."""
    path = viewer.session.file.path
    viewer.files.ask(
        "Save script",
        lambda chosen: _write_script(viewer, chosen, then),
        saving=True,
        proposed=str(path.absolute()) if path is not None else "script.toml",
    )


def _write_script(viewer: Viewer, path: Path, then: Callable[[], None]) -> None:
    viewer.session.save_script(path)
    apart = viewer.session.has_unsaved_pose
    rest = "; the pose is not part of it: K makes it a key" if apart else ""
    viewer.messages.say(f"{path}: script written{rest}")
    then()


def save_pose(viewer: Viewer, then: Callable[[], None] = _nothing) -> None:
    """Ask for a name, write the pose, and go on with `then`."""

    def write(path: Path) -> None:
        viewer.session.save_pose(path)
        viewer.messages.say(f"{path}: pose written")
        then()

    viewer.files.ask("Save pose", write, saving=True, proposed="pose.toml")


def screenshot(viewer: Viewer) -> None:
    """Write the picture without panels, in full detail, into the present folder."""
    target = free_name(Path.cwd(), ".png")
    save_png(target, viewer.stage.photograph(*viewer.scene_view))
    viewer.messages.say(f"{target.name}: written to {target.parent}")


def toggle_film(viewer: Viewer) -> None:
    """Begin a film of what is shown in the present folder, or finish it."""
    if viewer.film is None:
        viewer.film = Film(free_name(Path.cwd(), ".mp4"))
        return
    film, viewer.film = viewer.film, None
    film.close()
    if film.frame_count:
        viewer.messages.say(f"{film.target.name}: {film.seconds:.1f} s in {film.target.parent}")


def recover(viewer: Viewer) -> None:
    """Go on with what a window before this one has left behind, unless work would be lost."""
    viewer.question.before(viewer, "Recover", lambda: viewer.recovery.take_found(viewer.session))


def close_politely(viewer: Viewer) -> None:
    """Close the window, unless work would be lost: then ask first."""

    def close() -> None:
        viewer.is_leaving = True
        viewer.surface.should_close = True

    if viewer.is_leaving:
        close()
    else:
        viewer.question.before(viewer, "Close", close)


# Face and time


def randomise(viewer: Viewer) -> None:
    """A face by chance."""
    viewer.session.randomise(viewer.generator)


def select_muscle(viewer: Viewer, name: str | None) -> None:
    """Show a muscle's slider."""
    if name is not None:
        viewer.wanted_tab = "Face"
        viewer.face_panel.select(name)
        viewer.messages.say(name.replace("_", " "))


def toggle_playing(viewer: Viewer) -> None:
    """Play the script or pause it."""
    viewer.session.toggle_playing()


def toggle_recording(viewer: Viewer) -> None:
    """Record the sliders, or take the recording as the script."""
    viewer.session.toggle_recording()
    if not viewer.session.is_recording:
        viewer.messages.say("recorded; Space plays it, Ctrl+S saves it")


def toggle_looping(viewer: Viewer) -> None:
    """Play the script again and again, or once."""
    viewer.session.is_looping = not viewer.session.is_looping


# Look


def toggle(viewer: Viewer, name: str) -> None:
    """Switch a field of the look that is on or off."""
    setattr(viewer.look, name, not getattr(viewer.look, name))


def switch(viewer: Viewer, name: str, value: str, other: str) -> None:
    """Give a field of the look this value, or the other if it has it already."""
    setattr(viewer.look, name, other if getattr(viewer.look, name) == value else value)


def toggle_overlay(viewer: Viewer, name: str) -> None:
    """Show an overlay or hide it."""
    shown = viewer.look.overlays
    viewer.look.overlays = [*shown, name] if name not in shown else [n for n in shown if n != name]


def next_shading(viewer: Viewer) -> None:
    """Flat, Gouraud, per pixel, and round again."""
    order = [shading.value for shading in render.Shading]
    viewer.look.shading = order[(order.index(viewer.look.shading) + 1) % len(order)]


def frame_face(viewer: Viewer) -> None:
    """The camera as at first: all of the scene."""
    viewer.camera = whole_scene(viewer.scene, viewer.session.script.camera)


def toggle_theme(viewer: Viewer) -> None:
    """Light or dark."""
    viewer.settings.theme = "light" if viewer.settings.theme == "dark" else "dark"


def enlarge(viewer: Viewer, factor: float) -> None:
    """Make words and sliders larger or smaller."""
    least, most = ZOOMS
    viewer.settings.zoom = min(max(viewer.settings.zoom * factor, least), most)


def toggle_full(viewer: Viewer) -> None:
    """Fill the screen, or go back."""
    viewer.placement.toggle_full()
    if viewer.placement.is_full:
        viewer.messages.say("F11 leaves the full screen")


def toggle_panels(viewer: Viewer) -> None:
    """Hide all but the picture, or show it again."""
    viewer.is_bare = not viewer.is_bare
    if viewer.is_bare:
        viewer.messages.say("Tab brings the panels back")


def toggle_help(viewer: Viewer) -> None:
    """Show the sheet of keys or hide it."""
    viewer.is_help_open = not viewer.is_help_open


# What is remembered


def remember(viewer: Viewer) -> None:
    """Write the settings as they are now; UserError where that cannot be."""
    if viewer.settings_path is None:
        return
    camera, settings = viewer.camera, viewer.settings
    place = [camera.yaw, camera.pitch, camera.distance, *camera.target.tolist()]
    settings.cameras[viewer.scene.name] = [float(number) for number in place]
    settings.look = viewer.look
    settings.size = viewer.placement.size
    save_settings(viewer.settings_path, settings)


def remembered_camera(viewer: Viewer) -> render.OrbitCamera | None:
    """The camera where it stood when this scene's window was closed, or None."""
    place = viewer.settings.cameras.get(viewer.scene.name)
    try:
        yaw, pitch, distance, *target = [float(number) for number in place or ()]
    except (TypeError, ValueError):
        return None
    if len(target) != 3 or not np.isfinite([yaw, pitch, distance, *target]).all():
        return None
    camera = whole_scene(viewer.scene, None)
    camera.orbit(yaw - camera.yaw, pitch - camera.pitch)
    camera.target = np.array(target)
    camera.distance = min(max(distance, camera.scene_radius), 20.0 * camera.scene_radius)
    return camera
