"""Built-in things to simulate and draw: the head, the paper's plane, a cloth over a ball.

    head = assets.load("head")
    plane = assets.load("plane")
    cloth = assets.load("cloth")
    mesh = assets.read_mesh("cloth.ply")  # or OBJ, STL, OFF, GLB
    head = fitting.fit_head("anna.obj", "anna.json")  # from risorius.assets import fitting

The built-in head ships as data; docs/head.md says what it was fitted to.
"""

from .errors import AssetError
from .loading import available, load
from .meshes import Mesh, read_mesh
from .model import Cloth, Eye, FineShape, Head, Layer, Part, Plane, Segment, Wrinkles

__all__ = [
    "AssetError",
    "Cloth",
    "Eye",
    "FineShape",
    "Head",
    "Layer",
    "Mesh",
    "Part",
    "Plane",
    "Segment",
    "Wrinkles",
    "available",
    "load",
    "read_mesh",
]
