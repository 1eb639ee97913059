"""The window: a face that answers to sliders, keys, the mouse and a script.

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

from . import gui  # first, before anything opens a window: see there
from .window import Viewer

__all__ = ["Viewer", "gui"]
