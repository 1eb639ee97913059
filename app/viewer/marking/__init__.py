"""Marking the 68 landmarks of a mesh by the mouse.

marking.py  the mesh, where its landmarks are so far, undo, files; knows no windows
picture.py  the mesh as it is seen, and the mouse on it
panel.py    the task beside it, and the marks over it
mode.py     all of them in the window, with its commands
"""

from .marking import Marking
from .mode import MarkingMode

__all__ = ["Marking", "MarkingMode"]
