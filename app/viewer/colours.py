"""What colours the triangles: how often they were split, how far they bend, how they are strained.

Every amount belongs to a triangle of the mesh that is simulated; refined triangles take it from
their source. So the same colours are seen with and without refinement.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.geometry.normals import vertex_normals
from risorius.render.style import AMOUNT_RAMP, SIGNED_RAMP

from ..capture.captions import SPLITS_BAR, ColourBar
from ..pipeline import SourceValues
from ..scenes import Scene

MOST_DROP = 0.3  # of the normals' dot product, drawn darkest: a bend of 45 degrees
MOST_STRAIN = 0.35  # of a length, drawn darkest; skin stiffens well before

FloatArray = npt.NDArray[np.float64]
Amounts = npt.NDArray[np.uint8]


@dataclass(frozen=True)
class Colours:
    """A way to colour triangles: how the renderer takes the values, and what they mean."""

    kind: render.ColourBy
    bar: ColourBar | None = None
    of_source: SourceValues | None = None


def curvature_drops(scene: Scene, refiner: refine.Refiner) -> Amounts:
    """How far the dot product of the normals fell along the worst edge of each triangle."""
    edges = refiner.edges
    now, rest = (
        _dots(vertex_normals(positions, scene.faces), edges)
        for positions in (scene.positions, scene.rest_positions)
    )
    worst = (rest - now)[refiner.triangle_edges].max(axis=1)
    return np.asarray(np.clip(255.0 * worst / MOST_DROP, 0.0, 255.0), np.uint8)


def tensions(scene: Scene, refiner: refine.Refiner) -> Amounts:
    """How far each triangle is stretched, less how far it is compressed."""
    anything: Any = scene
    stretch, compression = _tension_of(anything).measure(scene.positions)
    tension = (stretch - compression)[scene.faces].mean(axis=1)
    return np.asarray(np.clip(128.0 + 127.0 * tension / MOST_STRAIN, 0.0, 255.0), np.uint8)


@functools.lru_cache(maxsize=1)  # the scene that is shown; one before it may go
def _tension_of(scene: Any) -> refine.Tension:
    return refine.Tension(scene.faces, scene.rest_positions)


def _dots(normals: FloatArray, edges: npt.NDArray[np.int32]) -> FloatArray:
    dots: FloatArray = (normals[edges[:, 0]] * normals[edges[:, 1]]).sum(axis=1)
    return dots


DROPS = ("0", f"{MOST_DROP / 2.0:g}", f"{MOST_DROP:g}")
STRAINS = (f"-{100 * MOST_STRAIN:g} %", "0", f"+{100 * MOST_STRAIN:g} %")
COLOURS = {
    "none": Colours(render.ColourBy.NONE),
    "splits": Colours(render.ColourBy.SPLITS, SPLITS_BAR),
    "curvature drop": Colours(
        render.ColourBy.AMOUNT,
        ColourBar("Curvature: drop of n · n at rest", AMOUNT_RAMP, DROPS),
        curvature_drops,
    ),
    "tension": Colours(
        render.ColourBy.SIGNED,
        ColourBar("Tension: change of length", SIGNED_RAMP, STRAINS),
        tensions,
    ),
}
