"""Draw the folds of a person's upper lids: the height of the crease, and the overhang above it.

Below the crease of an open eye, skin 1.4 ± 1.1 mm high is visible in white persons of 41 to 60
years. It is higher in women, and varies more with age (Cartwright and others 1994, "Measurements of
upper eyelid and eyebrow dimensions in healthy white individuals", Am. J. Ophthalmology
117:231-234). We assume this spread for all people.

Only the map of wrinkles has the fold, which also shows at rest. The fold flattens where the skin is
stretched, because its skin covers the eyeball when the lid shuts.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64
from ...geometry.steps import smoothstep
from ...geometry.texels import Texels
from ..loading import load
from ..model import Wrinkles
from ..smooth import bump
from .person import Person
from .relief import Relief, add_to, relief_of, texels_of

EYE_SIDES = ("left", "right")
EDGE_VERTEX_COUNT = 11  # vertices on the edge of an upper lid
# Samples of the edge's curve, from which searches for the nearest point begin.
CURVE_SAMPLE_COUNT = 81


def with_folds(wrinkles: Wrinkles, person: Person) -> Wrinkles:
    """Draw the folds of a person's upper lids, which also show at rest, into wrinkles."""
    found = wrinkles.map.copy()
    size = len(found)
    for side in EYE_SIDES:
        fold = fold_of(person, side, size)
        near = found[fold.rows, fold.columns, :3]
        down, right = np.gradient(fold.heights.astype(np.float32))
        darkest = 2.3  # bytes of depth for each byte of lost light
        more = np.stack([right, -down, (1.0 - fold.light).astype(np.float32)], axis=2)
        steep = 127.0 * size / wrinkles.steepest
        add_to(near, more * np.array([steep, steep, 255.0 * darkest], np.float32))
    found.flags.writeable = False
    resting = np.maximum(wrinkles.resting, _wrinkles_of_upper_lids()[1])
    folded = replace(wrinkles, map=found, resting=resting, folds=_wrinkles_of_upper_lids()[1])
    return with_lids(folded)


def with_lids(wrinkles: Wrinkles) -> Wrinkles:
    """Add the upper lids to the skin on which stretch smooths wrinkles."""
    across, lids = _wrinkles_of_upper_lids()
    return replace(wrinkles, across=across, lids=lids)


@lru_cache(maxsize=1)
def _wrinkles_of_upper_lids() -> tuple[Floats32, Floats32]:
    """Return `across` of the wrinkles with upper lids, and which vertices have folds, (V,).

    Folds run along the lid, so their skin yields perpendicular to the lid's edge.
    """
    head = load("head")
    across = head.wrinkles.across.copy()
    has_fold = np.zeros(len(across), np.float32)
    for side in EYE_SIDES:
        edge = _lid_edge(head.vertices, side)
        along = _nearest(head.vertices, edge)
        offset = head.vertices - _edge_weights(along) @ edge
        away = np.linalg.norm(offset, axis=1)
        is_seen = (offset[:, 1] > -0.1) & (offset[:, 2] > -4.0)
        is_between = (along > 0.15) & (along < 0.95)
        reach = 6.5  # [mm] from the lid's edge to the end of the overhanging skin
        is_lid = is_seen & is_between & (away < reach)
        has_fold[is_lid] = 1.0
        is_free = is_lid & (across == 0.0).all(axis=(1, 2))
        upward = offset / np.maximum(away, 1e-6)[:, None]
        upward[away < 0.5] = [0.0, 1.0, 0.0]
        across[is_free] = upward[is_free, None]
    for each in (across, has_fold):
        each.flags.writeable = False
    return across, has_fold


def fold_of(person: Person, side: str, size: int) -> Relief:
    """Draw the fold of one upper lid into a map of (size, size) texels.

    All lengths are chosen by eye, except the height of the visible skin.
    """
    near = _texels_around(side, size)
    texels = near.texels
    along = near.along
    places = texels.interpolate(person.vertices[person.faces])
    offset = places - near.edge_weights @ _lid_edge(person.vertices, side)
    away = np.sqrt((offset**2).sum(axis=1))
    upward = offset[:, 1] / np.maximum(away, 0.1)
    is_lid = smoothstep(upward, 0.15, 0.6) * smoothstep(along, 0.03, 0.15)
    arch = 0.35 + 0.65 * np.sin(np.pi * np.clip(0.1 + 0.75 * along, 0.0, 1.0))
    identity = person.identity
    seen = identity.seen_lid * arch - identity.hooding * smoothstep(along, 0.35, 1.0)
    above = away - np.maximum(seen, 0.0)  # the crease
    # Heights of visible skin [mm]: the fold hides the whole crease, or nothing of it.
    shows = is_lid * smoothstep(seen, -0.2, 0.5)
    groove_width = 0.6  # [mm]
    groove = bump(above, 0.0, groove_width) * shows
    hangs = smoothstep(above, -0.1, 1.3) * (1.0 - smoothstep(above, 2.0, 7.0)) * is_lid
    groove_depth = 0.2  # [mm]
    fold_height = 0.55 + 0.25 * identity.hooding  # [mm]
    crease_dark = 0.4  # fraction of ambient light that a crease loses
    below_dark = 0.2  # fraction of ambient light that the skin below a fold loses
    below = shows * (1.0 - smoothstep(above, -1.2, 0.3)) * smoothstep(away, 0.0, 0.4)
    heights = fold_height * hangs - groove_depth * groove
    return relief_of(texels, heights, 1.0 - crease_dark * groove - below_dark * below)


class _EyeTexels(NamedTuple):
    """The texels around an eye, and the nearest point on the upper lid's edge for each of them.

    along: position of this point along the edge of the built-in head's lid, (n,), from 0 at the
        inner corner to 1 at the outer one.
    edge_weights: weights of the edge's vertices at this point, (n, EDGE_VERTEX_COUNT).
    """

    texels: Texels
    along: Floats64
    edge_weights: Floats64


def _lid_edge(vertices: Floats64, side: str) -> Floats64:
    """Return an upper lid's edge from the inner corner [mm], (EDGE_VERTEX_COUNT, 3)."""
    return vertices[load("head").rings[f"eye_2_{side}"][:EDGE_VERTEX_COUNT]]


def _edge_weights(along: Floats64, derivative: int = 0) -> Floats64:
    """Return weights of the edge's vertices along its curve, or their derivatives.

    The shape is (n, EDGE_VERTEX_COUNT).
    """
    places = along * (EDGE_VERTEX_COUNT - 1.0)
    scale = (EDGE_VERTEX_COUNT - 1.0) ** derivative
    columns = [curve(places, nu=derivative) for curve in _weight_curves()]
    return scale * np.column_stack(columns)


@lru_cache(maxsize=1)
def _weight_curves() -> list[scipy.interpolate.BSpline]:
    """Return the weight of each vertex of an edge along its curve.

    The curve is a smoothing spline that passes near the vertices. A curve through them would have
    corners, and so would the crease parallel to it.
    """
    bend_cost = 1.0  # weight of squared second derivatives, relative to squared distances
    numbers = np.arange(float(EDGE_VERTEX_COUNT))
    return [
        scipy.interpolate.make_smoothing_spline(numbers, each, lam=bend_cost)
        for each in np.eye(EDGE_VERTEX_COUNT)
    ]


def _nearest(places: Floats64, points: Floats64) -> Floats64:
    """Find the nearest points of an edge's curve for places (n, 3); returns positions 0 to 1.

    points: vertices of the edge [mm], (EDGE_VERTEX_COUNT, 3).
    """
    steps = np.linspace(0.0, 1.0, CURVE_SAMPLE_COUNT)
    along = steps[scipy.spatial.cKDTree(_edge_weights(steps) @ points).query(places)[1]]
    for _ in range(2):  # by Newton's method
        offset, first, second = (_edge_weights(along, n) @ points for n in range(3))
        offset = places - offset
        slope = (offset * first).sum(axis=1)
        bend = (offset * second).sum(axis=1) - (first**2).sum(axis=1)
        along = np.clip(along - slope / np.minimum(bend, -1.0), 0.0, 1.0)
    return np.asarray(along, np.float64)


@lru_cache(maxsize=8)
def _texels_around(side: str, size: int) -> _EyeTexels:
    head = load("head")
    reach = 11.0  # [mm] around the edge of the lid, beyond all folds
    points = _lid_edge(head.vertices, side)
    curve = scipy.spatial.cKDTree(_edge_weights(np.linspace(0.0, 1.0, CURVE_SAMPLE_COUNT)) @ points)
    is_near = (curve.query(head.vertices)[0] < reach)[head.faces].any(axis=1)
    texels = texels_of(is_near, size)
    places = texels.interpolate(head.vertices[head.faces])
    along = _nearest(places, points)
    edge_weights = _edge_weights(along)
    offset = places - edge_weights @ points
    kept = (np.linalg.norm(offset, axis=1) < reach) & (offset[:, 1] > -0.2)
    return _EyeTexels(texels.only(kept), along[kept], edge_weights[kept])
