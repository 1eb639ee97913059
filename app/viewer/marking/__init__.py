"""Marking the 68 landmarks of a mesh by the mouse.

marking.py  the mesh, where its landmarks are so far, undo, files; knows no windows
mode.py     the picture, the questions to the user, the mouse, and commands
"""

from .marking import Marking
from .mode import MarkingMode

__all__ = ["Marking", "MarkingMode"]
