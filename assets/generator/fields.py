"""Implicit surfaces: functions of points that are negative inside, about a distance in mm.

Primitives, smooth unions of them, and the two questions the mesher asks: where is the surface
near this point, and where does this ray enter it?
Source of the smooth minimum: Quílez, "smooth minimum" (polynomial form), a well-known recipe.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
Values = npt.NDArray[np.float64]
Grid = npt.NDArray[Any]  # values of single or double precision
Field = Callable[[Points], Values]

GRADIENT_STEP = 0.15  # [mm]; chosen: well below the finest edge, well above rounding


def smooth_minimum(first: Grid, second: Grid, radius: float | Values) -> Grid:
    """Join two fields; `radius` [mm] is the width of the fillet between them."""
    overlap = np.maximum(radius - np.abs(first - second), 0.0) / radius
    joined: Grid = np.minimum(first, second) - overlap * overlap * radius * 0.25
    return joined


def smooth_maximum(first: Grid, second: Grid, radius: float | Values) -> Grid:
    """Intersect two fields; subtract one by passing its negative."""
    return -smooth_minimum(-first, -second, radius)


def smooth_step(low: float, high: float, values: Values) -> Values:
    """Rise from 0 at `low` to 1 at `high` without a kink."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def bump(values: Values, centre: float, width: float) -> Values:
    """A bell of height 1 around `centre`, down to 1/e at `width`."""
    return np.exp(-(((values - centre) / width) ** 2))


def sphere(points: Points, centre: tuple[float, float, float], radius: float) -> Values:
    """Distance to a ball."""
    result: Values = np.linalg.norm(points - np.array(centre), axis=1) - radius
    return result


def ellipsoid(
    points: Points,
    centre: tuple[float, float, float],
    radii: tuple[float, float, float],
    *,
    turn_deg: float = 0.0,
) -> Values:
    """Approximate distance to an ellipsoid turned about the vertical axis."""
    turn = np.radians(turn_deg)
    cosine, sine = np.cos(turn), np.sin(turn)
    rotation = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    local = (points - np.array(centre)) @ rotation
    scaled = np.linalg.norm(local / np.array(radii), axis=1)
    slope = np.linalg.norm(local / np.array(radii) ** 2, axis=1)
    result: Values = scaled * (scaled - 1.0) / np.maximum(slope, 1e-9)
    return result


def tapered_capsule(
    points: Points,
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    start_radius: float,
    end_radius: float,
) -> Values:
    """Approximate distance to a capsule whose radius changes along its axis."""
    origin = np.array(start)
    axis = np.array(end) - origin
    along = np.clip((points - origin) @ axis / (axis @ axis), 0.0, 1.0)
    radius = start_radius + (end_radius - start_radius) * along
    result: Values = np.linalg.norm(points - origin - along[:, None] * axis, axis=1) - radius
    return result


def gradient(field: Field, points: Points) -> Points:
    """Central differences of a field, shape (n, 3)."""
    result = np.empty_like(points)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = GRADIENT_STEP
        result[:, axis] = (field(points + step) - field(points - step)) / (2.0 * GRADIENT_STEP)
    return result


def unit(vectors: Points) -> Points:
    """Scale rows to length 1; zero rows stay zero."""
    scaled: Points = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
    return scaled


def normals(field: Field, points: Points) -> Points:
    """Outward unit normals of the surface near the points, shape (n, 3)."""
    return unit(gradient(field, points))


def project(field: Field, points: Points, *, rounds: int = 4) -> Points:
    """Bring points onto the surface by Newton steps of at most 2 mm along the gradient."""
    result = points.copy()
    for _ in range(rounds):
        slope = gradient(field, result)
        squared = np.maximum((slope**2).sum(axis=1), 0.15)
        step = (field(result) / squared)[:, None] * slope
        length = np.linalg.norm(step, axis=1, keepdims=True)
        result -= step * np.minimum(1.0, 2.0 / np.maximum(length, 1e-9))
    return result


def cast(
    field: Field, origins: Points, directions: Points, *, reach: float, step: float = 2.0
) -> Points:
    """Walk from the origins along unit directions and return where the field is first entered.

    reach: how far to walk [mm]. Rays that miss end at their last point.
    """
    steps = np.arange(0.0, reach + step, step)
    near = np.full(len(origins), np.nan)
    open_rays = np.arange(len(origins))
    for distance in steps:
        inside = field(origins[open_rays] + distance * directions[open_rays]) <= 0.0
        near[open_rays[inside]] = distance
        open_rays = open_rays[~inside]
        if len(open_rays) == 0:
            break
    far = np.where(np.isnan(near), reach, near)
    near = np.maximum(far - step, 0.0)
    for _ in range(18):
        middle = 0.5 * (near + far)
        inside = field(origins + middle[:, None] * directions) <= 0.0
        far = np.where(inside, middle, far)
        near = np.where(inside, near, middle)
    return origins + (0.5 * (near + far))[:, None] * directions
