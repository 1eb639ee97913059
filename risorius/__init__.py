"""Risorius: physics-based facial animation with dynamically refined triangle meshes.

    from risorius import assets, refine, render, sim

Four packages that know nothing of each other, and `risorius.app`, which joins them.
"""

__version__ = "0.2.0"
