"""Marking the 68 landmarks of a mesh by the mouse.

marks.py      where the landmarks are so far, and what each is called
marking.py    the mesh, what is done to its marks, undo, files
picture.py    what is drawn: the mesh, and a guide with the point that is asked for
mouse.py      marks placed and dragged, the camera turned
panel.py      what is asked, what can be done, the points over the mesh
room.py       all of it joined, and its commands
"""

from .marking import Marking
from .room import Room

__all__ = ["Marking", "Room"]
