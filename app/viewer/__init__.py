"""The window: a face that answers to sliders, keys, the mouse and a script.

window.py     one turn of the loop: input, time, picture, panels     (start reading here)
session.py    what the user does: controls, script, recording, undo, unsaved work; knows no window
keys.py       what can be done with the keys of a script; panels/dope_sheet.py is where
stage.py      which meshes are drawn where, how they are coloured, what lies over them
touch.py      the mouse in the picture
actions.py    every key and menu, as data
panels/       what stands around the picture
quality.py, clock.py    the two that keep it smooth: detail by need, physics by steps
recovery.py, unsaved.py    unsaved work outlives a crash
"""

from . import gui  # first, before anything opens a window: see there
from .window import Viewer

__all__ = ["Viewer", "gui"]
