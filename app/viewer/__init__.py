"""The window: a face that sliders, keys, the mouse and a script move.

window/     both modes and the loop (window.py: start reading here), menus, splash screen
context.py  the objects that the parts share
marking/    marking of a mesh's landmarks, displayed instead of the face
panels/     the panels around the picture
timeline/   the script below the picture: keys as rows or curves, and the sound
documents/  opening and saving of scripts, heads and exports, with their dialogs
picture/    the picture: camera, meshes, colours, times of drawing, actions of the mouse
session/    the user's work: controls, script, recording, undo, unsaved work; knows no window
interface/  Dear ImGui, commands, small widgets
settings.py the remembered settings, including the display of the scene
"""

from typing import TYPE_CHECKING, Any

from ..extras import optional_import

# Before glfw, see gui.py.
optional_import("imgui_bundle", "the window", "window", package="imgui-bundle")
optional_import("glfw", "the window", "window")

from .interface import gui  # noqa: E402 - before other modules import glfw: see gui.py

if TYPE_CHECKING:
    from .window.window import Viewer


def __getattr__(name: str) -> Any:
    """Import `Viewer` at its first use, because the splash screen opens earlier."""
    if name != "Viewer":
        raise AttributeError(name)
    from .window.window import Viewer

    return Viewer


__all__ = ["Viewer", "gui"]
