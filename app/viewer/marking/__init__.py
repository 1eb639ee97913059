"""Marking the 68 landmarks of a mesh by the mouse.

marking.py  the mesh, where its landmarks are so far, undo, files; knows no windows
room.py     the picture, the questions to the user, the mouse, and commands
"""

from .marking import Marking
from .room import Room

__all__ = ["Marking", "Room"]
