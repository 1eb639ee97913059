"""Built-in things to simulate and draw: the head and the paper's plane.

    head = assets.load("head")
    plane = assets.load("plane")

The programs that generate them are in this package too; `python -m assets.build` runs them.
"""

from .loading import AssetError, available, load
from .model import Eye, Head, Part, Plane

__all__ = ["AssetError", "Eye", "Head", "Part", "Plane", "available", "load"]
