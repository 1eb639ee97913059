"""The window: a face that answers to sliders, keys, the mouse and a script.

opening.py    the window as it opens, before anything else is there
parts.py      joins everything     (start reading here)
window.py     one turn of the loop, and when it rests
session.py    what the user does: controls, script, recording, undo, unsaved work; knows no window
settings.py   what is remembered, how the scene is displayed among it
view.py       camera, display and place of the scene in the window
stage.py      which meshes are drawn where, how they are coloured, what lies over them
menus.py      every key and menu, as data; what they call:
              script_commands.py, key_selection.py, file_drop.py, export.py, and the four above
panels/       what stands around the picture; mouse.py is the mouse in it
painter.py, physics.py, panel_cache.py     what keeps it smooth: each does no more than is due
recovery.py, unsaved.py    unsaved work outlives a crash
"""

from typing import TYPE_CHECKING, Any

from ..errors import needed

needed("imgui_bundle", "the window", "window", package="imgui-bundle")  # before glfw: see gui.py
needed("glfw", "the window", "window")

from . import gui  # noqa: E402 - first, before anything opens a window: see there

if TYPE_CHECKING:
    from .window import Viewer


def __getattr__(name: str) -> Any:
    """`Viewer`, imported when it is asked for: the window opens before (opening.py)."""
    if name != "Viewer":
        raise AttributeError(name)
    from .window import Viewer

    return Viewer


__all__ = ["Viewer", "gui"]
