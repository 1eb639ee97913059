"""Risorius: physics-based facial animation with dynamically refined triangle meshes.

    from risorius import assets, refine, render, sim

These four packages are independent of each other; `risorius.app` joins them.
"""

__version__ = "0.2.0"
