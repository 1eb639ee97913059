"""The window: a face that sliders, keys, the mouse and a script move.

window/     both modes and the loop (window.py: start reading here), menus, splash screen
context.py  the objects that the parts share
marking/    landmarks of a mesh, marked in place of the face
panels/     the panels around the picture
timeline/   the script below it: keys in rows and as curves, the sound
documents/  scripts, heads and exports: opened, asked for, saved
picture/    the picture: camera, meshes and colours, when it is drawn; the mouse in it
session/    the user's work: controls, script, recording, undo, unsaved work; knows no window
interface/  Dear ImGui, commands, small widgets
settings.py the settings that are remembered, among them how the scene is displayed
"""

from typing import TYPE_CHECKING, Any

from ..extras import needed

needed("imgui_bundle", "the window", "window", package="imgui-bundle")  # before glfw: see gui.py
needed("glfw", "the window", "window")

from .interface import gui  # noqa: E402 - first, before anything opens a window: see there

if TYPE_CHECKING:
    from .window.window import Viewer


def __getattr__(name: str) -> Any:
    """`Viewer`, imported at its first use: the window opens before that (splash_screen.py)."""
    if name != "Viewer":
        raise AttributeError(name)
    from .window.window import Viewer

    return Viewer


__all__ = ["Viewer", "gui"]
