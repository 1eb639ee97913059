"""What closes the holes of a head without skin: the back of its throat, and the end of its neck.

Both are sheets that are seen from one side alone: through the mouth, and from above.
Measures [mm of a head of skull.EYES, off the condyles' middle]: chosen.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.geometry.normals import vertex_normals

from .model import Part
from .skull import origin_and_scale
from .topology import boundary_loops, halved, quads_between

Floats = npt.NDArray[np.float64]
ASIDE, HIGH, LOW = 40.0, -26.0, -100.0  # of the throat: to the jaw, from the skull to its floor
SIDES, MIDDLE, FLOOR = 6.0, -8.0, 12.0  # how far forward: its sides, more in the middle, its floor
# sRGB
THROAT, DARK = np.array([0.36, 0.13, 0.12]), np.array([0.10, 0.035, 0.035])
FAT, FLESH = np.array([0.82, 0.62, 0.42]), np.array([0.50, 0.17, 0.15])
RINGS = (0.0, FLESH), (0.5, FLESH), (0.93, FLESH), (0.95, FAT), (1.0, FAT)  # how far out; colour


def build_throat(head: Any, pivots: Mapping[str, Floats]) -> list[Part]:
    """The sheets at rest; of a head whose neck has no open end, the throat alone.

    head: with vertices, faces, landmarks. pivots: what "mandible" turns about, by bones, each (3,).
    """
    origin, scale = origin_and_scale(head, pivots)
    across, down = np.meshgrid(np.linspace(-1.0, 1.0, 17), np.linspace(0.0, 1.0, 13))
    forward = SIDES + MIDDLE * (1.0 - across**2) + FLOOR * down**4
    places = np.stack(
        [ASIDE * across * (1.0 - 0.7 * down**2), HIGH + (LOW - HIGH) * down, forward], axis=-1
    )
    colours = DARK + (0.35 * down + 0.65 * across**2)[..., None] * (THROAT - DARK)
    parts = [_sheet("throat", origin + scale * places, colours, "cranium")]
    chin = head.vertices[head.landmarks[8], 1]
    for loop in boundary_loops(head.faces):
        edge = head.vertices[loop]
        if edge[:, 1].max() < chin:
            middle = edge.mean(axis=0)
            rings = np.stack([middle + share * (edge - middle) for share, _ in RINGS])
            inks = np.stack([np.tile(ink, (len(loop), 1)) for _, ink in RINGS])
            parts.append(_sheet("neck_section", rings, inks, "neck", closed=True))
    return parts


def _sheet(name: str, rows: Floats, colours: Floats, bone: str, *, closed: bool = False) -> Part:
    """Rows of points, (n, m, 3), seen from where they turn counter-clockwise."""
    points = rows.reshape(-1, 3)
    numbers = [row.tolist() for row in np.arange(len(points)).reshape(rows.shape[:2])]
    faces = halved(points, quads_between(numbers, closed=closed))
    places, normals, inks = (
        each.astype(np.float32)
        for each in (points, vertex_normals(points, faces), colours.reshape(-1, 3))
    )
    return Part(name, places, normals, faces, inks, bone, 0.3)
