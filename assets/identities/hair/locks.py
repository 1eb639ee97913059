"""Locks of hair: flat bands along lines, bulging a little, with their place along and across."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy

from ...around import direction_coordinates, rays
from ...smooth import Points, Values, unit
from ...solids import grid_faces

# The cross-section: place across it, how far it bulges out, and its normal, across and out.
# Edges go down: seen from its side a lock is no line, and has no gap below it.
SECTION = np.array([(-1.0, -0.8, -0.2, 1.0), (0.0, 1.0, 0.0, 1.0), (1.0, -0.8, 0.2, 1.0)])
CLOSER = 1.25  # power of shares of the length: more rows near the root, where locks bend most
DEPTH = 0.18  # of a lock, by its width
TURN = 0.1  # [rad] by which locks are twisted
SHADES = (0.94, 1.02, 0.94)  # of colour over the section
UNEVEN = 0.025  # by which locks differ in colour
UNDER = 0.1  # by how much what lies under others is darker
ALIKE, TURNED = 16, 40.0  # neighbours that are lit as one, and how far off one is by its way [mm]
GRAIN = 400.0  # [mm] of the striation's pattern from which each lock takes its own


class Look(NamedTuple):
    """Locks: least and greatest width [mm], that of their ends as a share, rows of vertices."""

    widths: tuple[float, float]
    end: float
    rows: int


def locks_along(
    lines: list[Points], layer: Values, look: Look, colour: Values, random: np.random.Generator
) -> dict[str, Any]:
    """The arrays of a `Part`: vertices, normals, faces, colours, striation.

    lines: of the locks, each (k, 3) [mm] with a k of its own. layer: 0 for the lowest, 1 for the
    uppermost. colour: the mean of all (sRGB).
    """
    count, place = len(lines), np.linspace(0.0, 1.0, look.rows) ** CLOSER
    middle = np.array([_resampled(line, place) for line in lines])
    across, out = _frames(middle, random.normal(0.0, TURN, count))
    steps = np.linalg.norm(np.diff(middle, axis=1, prepend=middle[:, :1]), axis=2)
    along = np.cumsum(steps, axis=1)
    width = random.uniform(*look.widths, count)[:, None] * np.interp(
        place, [0.0, 0.12, 0.65, 0.9, 1.0], [0.5, 0.95, 1.0, 0.5 + 0.5 * look.end, look.end]
    )
    half = 0.5 * width[:, :, None, None]
    depth = DEPTH * (width * np.interp(place, [0.0, 0.2], [0.3, 1.0]))[:, :, None, None]
    aside, bulge, normal_aside, normal_out = SECTION.T[:, :, None]
    across, out = across[:, :, None], out[:, :, None]
    vertices = middle[:, :, None] + half * aside * across + depth * bulge * out
    ahead, out = (each[:, :, None] for each in _alike(middle, out[:, :, 0]))
    normals = unit((normal_aside * np.cross(ahead, out) + normal_out * out).reshape(-1, 3))
    start = random.uniform(0.0, GRAIN, (count, 1, 1, 2))
    widest = 0.5 * width.max(axis=1)[:, None, None]
    strands = start + np.stack(
        np.broadcast_arrays(widest * SECTION[:, 0], along[:, :, None]), axis=-1
    )
    tone = random.normal(1.0, UNEVEN, count) * (1.0 - UNDER * (1.0 - layer))
    tones = tone[:, None] * np.interp(place, [0.0, 0.25, 1.0], [0.9, 1.0, 1.04])
    tones = tones[:, :, None] * np.array(SHADES)
    tones /= tones.mean()
    faces = grid_faces(look.rows, len(SECTION))
    faces = faces + (np.arange(count) * look.rows * len(SECTION))[:, None, None]
    # The uppermost first: where nothing is multisampled, what they hide is not shaded then.
    faces = faces[np.argsort(-layer, kind="stable")]
    strands = np.concatenate([strands, np.broadcast_to(ahead, vertices.shape)], axis=-1)
    return {
        "vertices": vertices.reshape(-1, 3).astype(np.float32),
        "normals": normals.astype(np.float32),
        "faces": faces.reshape(-1, 3).astype(np.int32),
        "colours": np.clip(tones.reshape(-1, 1) * colour, 0.0, 1.0).astype(np.float32),
        "striation": strands.reshape(-1, 5).astype(np.float32),
    }


def _resampled(line: Points, place: Values) -> Points:
    """Points at shares of a line's length, shape (rows, 3)."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1e-6))])
    degree = min(3, len(line) - 1)
    return np.asarray(
        scipy.interpolate.make_interp_spline(along, line, k=degree)(place * along[-1])
    )


def _ahead(middle: Points) -> Points:
    """Unit vectors along the locks, shape (n, rows, 3)."""
    return unit(np.gradient(middle, axis=1).reshape(-1, 3)).reshape(middle.shape)


def _alike(middle: Points, out: Points) -> tuple[Points, Points]:
    """Ways along locks and out of them, each the mean of neighbours: they shine as one surface."""
    ahead = _ahead(middle)
    places = np.concatenate([middle, TURNED * ahead], axis=2).reshape(-1, 6)
    near = scipy.spatial.cKDTree(places).query(places, ALIKE)[1]
    means = (unit(each.reshape(-1, 3)[near].mean(axis=1)) for each in (ahead, out))
    ahead, out = (mean.reshape(middle.shape) for mean in means)
    return ahead, out


def _frames(middle: Points, turn: Values) -> tuple[Points, Points]:
    """Unit vectors across the locks and out of the head, shape (n, rows, 3) each."""
    ahead = _ahead(middle)
    angle, height, _ = direction_coordinates(middle.reshape(-1, 3))
    away = rays(angle, height)[1].reshape(middle.shape)
    across = unit(np.cross(ahead, away).reshape(-1, 3)).reshape(middle.shape)
    out = np.cross(across, ahead)
    cos, sin = np.cos(turn)[:, None, None], np.sin(turn)[:, None, None]
    return cos * across + sin * out, cos * out - sin * across
