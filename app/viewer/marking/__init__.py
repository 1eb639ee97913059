"""Marking the 68 landmarks of a mesh by the mouse.

marking.py  the mesh, its current landmarks, undo, files; independent of windows
picture.py  the picture of the mesh, and the mouse in it
panel.py    the panel beside the picture, and the marks over it
mode.py     these parts joined in the window, with the mode's commands
"""

from .marking import Marking
from .mode import MarkingMode

__all__ = ["Marking", "MarkingMode"]
