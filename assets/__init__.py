"""Built-in assets to simulate and draw: the head and the paper's plane.

    head = assets.load("head")
    plane = assets.load("plane")
    mesh = assets.read_mesh("sheet.ply")  # or OBJ, STL, OFF, GLB, glTF
    head = fitting.fit_head("anna.obj", "anna.json")  # from risorius.assets import fitting

The built-in head ships as data files; docs/head.md names the data to which it was fitted.
"""

from .errors import AssetError
from .loading import load
from .meshes import Mesh, read_mesh
from .model import Eye, FineShape, Head, Layer, Part, Plane, Segment, Wrinkles
from .oil import oil_of

__all__ = [
    "AssetError",
    "Eye",
    "FineShape",
    "Head",
    "Layer",
    "Mesh",
    "Part",
    "Plane",
    "Segment",
    "Wrinkles",
    "load",
    "oil_of",
    "read_mesh",
]
