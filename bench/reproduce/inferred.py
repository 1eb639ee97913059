"""What the paper leaves open, and what was put there.

Kähler, Haber, Seidel 2003 shows weights in Figures 3 and 4 alone, names no threshold, and leaves
both meshes and their animations to the reader. Values are read from the program.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import SupportsFloat

from risorius.app.refining.presets import PAPERS_PRESET, PRESETS
from risorius.app.scenes import PlaneScene
from risorius.assets.sheets import CELL, COLUMNS, ROWS
from risorius.refine.kahler import criterion, smoothing
from risorius.refine.mesh import rings


@dataclass(frozen=True)
class Inferred:
    """One thing that the paper does not give."""

    place: str
    """Where in the paper it is missing."""
    what: str
    value: str
    source: str
    """Why this value."""


def _share(weight: SupportsFloat) -> str:
    return str(Fraction(float(weight)).limit_denominator(64))


_PLANE = PRESETS[PAPERS_PRESET]["plane"].told("kahler")

INFERRED = (
    Inferred("4.1", "weights of vertex normals", "area of the triangles around", "usual"),
    Inferred(
        "4.1",
        "drop of the dot product at which an edge is split once, twice",
        f"{criterion.THRESHOLD_ONCE:g}, {criterion.THRESHOLD_TWICE:g}",
        "scanned full expressions then get the 1.5 times of Table 1",
    ),
    Inferred(
        "4.1",
        "the same for the plane",
        f"{_PLANE['threshold_once']:g}, {_PLANE['threshold_twice']:g}",
        "searched for the triangles of Table 1",
    ),
    Inferred(
        "4.1", "drop that is rounding", f"{criterion.ROUNDING:g}", "measured on rigid motions"
    ),
    Inferred(
        "4.2, Figure 3",
        "first-level point: ends of the edge, corners opposite",
        f"{_share(smoothing.EDGE_END)}, {_share(smoothing.EDGE_WING)}",
        "Loop 1987",
    ),
    Inferred(
        "4.2, Figure 3",
        "the same on a border: ends of the edge",
        _share(smoothing.BORDER_EDGE_END),
        "Loop 1987",
    ),
    Inferred(
        "4.2, Figure 3",
        "vertex with n neighbours: each neighbour, of three",
        "3/(8 n), 3/16; the rest is its own",
        "Warren's variant, which the paper names",
    ),
    Inferred(
        "4.2, Figure 3",
        "vertex on a border: itself, its neighbours along it",
        f"{_share(rings.BORDER_OWN)}, {_share(rings.BORDER_RING)}",
        "Warren's variant",
    ),
    Inferred("4.2", "which vertices move", "those with a split edge", "changes stay local"),
    Inferred(
        "4.2, Figure 4",
        "middle of an edge split twice: itself, its six neighbours",
        f"{_share(smoothing.MIDDLE_OWN)}, {_share(smoothing.MIDDLE_RING)}",
        "the vertex rule for six neighbours",
    ),
    Inferred(
        "4.2, Figure 4",
        "points of neighbour edges that enter the second level",
        "as the first level left them",
        "the order of edges cannot matter",
    ),
    Inferred(
        "4.3",
        "subtriangles of the 27 configurations",
        "cut off the ear with the shortest diagonal",
        "cuts off corners as Loop does; the paper shows examples",
    ),
    Inferred(
        "4.4",
        "order of splits that come in one frame",
        "the one with the shortest lines",
        "sequences know no other",
    ),
    Inferred(
        "5, Figure 9",
        "the plane",
        f"{COLUMNS} x {ROWS} cells of {CELL:g} mm, {PlaneScene.WAVES:g} waves, "
        f"{PlaneScene.HEIGHT:g} of its length high",
        "154 = 2 x 7 x 11; the wave by eye",
    ),
    Inferred(
        "5, Figure 10",
        "the face and its animation",
        "the built-in head of 2030 triangles, its own script",
        "the authors' scan is not public",
    ),
)
"""All of them, in the order of the paper."""
