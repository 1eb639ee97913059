"""What stands on the lids' edges and moves with them: lashes, and the wet edge above the lower lid.

A lash is a thin cone with three sides that leaves the lid's front edge forward and curls away from
the eye. The wet edge is a hollow strip of tears between the lower lid and the eyeball: wherever the
lamp is, some of it shines.

Sizes: lashes of the upper lid are 8 to 12 mm long, of the lower lid 6 to 8 mm; here shorter, for
the longest alone are that long. Fewer and thicker than in life, as they cling together.
"""

from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from .eye_rows import COLUMNS, eye_rows
from .fields import Points, Values, smooth_step, unit
from .form import EYE_CENTRE, EYE_RADIUS
from .solids import Solid, grid_faces, joined, mix

UPPER_COUNT, LOWER_COUNT = 46, 20
UPPER_LENGTH, LOWER_LENGTH = 6.6, 3.3  # [mm] of the longest
THICKNESS = 0.06  # [mm] half of it, at the root
PLACES = (0.0, 0.3, 0.65)  # of a lash's three rings; its tip is 1
ROOT_DEPTH = 0.25  # [mm] of roots below the skin
INNER_END, OUTER_END = 0.16, 0.985  # of the lid, between which lashes stand
COLOUR = (0.12, 0.085, 0.068)
WET_COLUMNS, WET_WIDTH, WET_ROWS = 19, 0.45, 3  # [mm] of the wet edge on the lid
WET_LIGHT, WET_DARK = (0.86, 0.74, 0.71), (0.78, 0.55, 0.51)  # on the eyeball, and on the lid
SEED = 7


def _edges(*, upper: bool) -> tuple[CubicSpline, CubicSpline]:
    """Inner and outer edge of a lid's margin over 0 (inner corner) to 1 (outer corner)."""
    half = COLUMNS // 2
    columns = np.arange(half + 1) if upper else -np.arange(half + 1) % COLUMNS
    place = np.linspace(0.0, 1.0, half + 1)
    _, inner, outer, *_ = eye_rows()
    return CubicSpline(place, inner[columns]), CubicSpline(place, outer[columns])


def _row_of_lashes(count: int, longest: float, *, upper: bool) -> Solid:
    """The lashes of one lid, each rooted in its first vertex."""
    random = np.random.default_rng(SEED + upper)
    inner, outer = _edges(upper=upper)
    solids: list[Solid] = []
    for number in range(count):
        place = INNER_END + (OUTER_END - INNER_END) * (number + random.uniform(0.2, 0.8)) / count
        shape = np.sin(np.pi * min(1.0, 0.12 + 0.8 * place)) ** 0.6 * random.uniform(0.75, 1.0)
        line = _lash(inner, outer, place, longest * shape, random, upper=upper)
        solids.append(_cone(line))
    return joined(solids)


def _lash(
    inner: CubicSpline, outer: CubicSpline, place: float, length: float,
    random: np.random.Generator, *, upper: bool,
) -> Points:  # fmt: skip
    """The middle line of a lash, shape (4, 3)."""
    root = outer(place) - 0.3 * random.uniform(0.0, 1.0) * (outer(place) - inner(place))
    ahead = unit((root - EYE_CENTRE)[None])[0]
    along = unit(outer(place, 1)[None])[0]
    away = np.cross(ahead, along) * (1.0 if upper else -1.0)
    away = unit((away if away[1] * (1.0 if upper else -1.0) > 0.0 else -away)[None])[0]
    # Fanned out: near the corners they lean to the side.
    aside = (0.85 * (place - 0.42) + random.normal(0.0, 0.10)) * along
    first, last = (-0.35, 1.15) if upper else (0.0, 0.75)
    at, line = root - ROOT_DEPTH * ahead, []
    steps = np.linspace(0.0, 1.0, 13)
    for low, high in pairwise(steps):
        line.append(at)
        curl = first + (last - first) * 0.5 * (low + high) + random.normal(0.0, 0.02)
        step = np.cos(curl) * ahead + np.sin(curl) * away + aside
        at = at + (high - low) * length * unit(step[None])[0]
    line.append(at)
    return np.array(line)[[round(12 * share) for share in (*PLACES, 1.0)]]


def _cone(line: Points) -> Solid:
    """Three sides around a line that end at its tip."""
    rows = []
    for k, place in enumerate(PLACES):
        along = unit((line[k + 1] - line[max(k - 1, 0)])[None])[0]
        side = unit(np.cross(along, [0.0, 0.0, 1.0])[None])[0]
        other = np.cross(along, side)
        radius = THICKNESS * (1.0 - 0.6 * place)
        rows += [
            line[k] + radius * (np.cos(turn) * side + np.sin(turn) * other)
            for turn in 2.0 * np.pi * np.arange(3) / 3.0
        ]
    sides = grid_faces(len(PLACES), 3, wrapped=True)
    last, tip = 3 * (len(PLACES) - 1), 3 * len(PLACES)
    ends = [[last + k, last + (k + 1) % 3, tip] for k in range(3)]
    vertices = np.vstack([*rows, line[-1]])
    faces = np.vstack([sides, ends]).astype(np.int32)
    roots = np.zeros(len(vertices), np.int32)
    return Solid(vertices, faces, np.tile(COLOUR, (len(vertices), 1)), roots)


def lashes() -> Solid:
    """The lashes of both eyes."""
    upper = _row_of_lashes(UPPER_COUNT, UPPER_LENGTH, upper=True)
    lower = _row_of_lashes(LOWER_COUNT, LOWER_LENGTH, upper=False)
    left = joined([upper, lower])
    return joined([left.mirrored(), left])


def wet_edges() -> Solid:
    """The tears along both lower lids; each vertex moves with the skin where it is itself."""
    inner, outer = _edges(upper=False)
    place = np.linspace(0.1, 0.95, WET_COLUMNS)
    width: Values = np.sin(np.pi * np.linspace(0.01, 0.99, WET_COLUMNS)) ** 0.8
    on_lid = inner(place) + WET_WIDTH * width[:, None] * unit(outer(place) - inner(place))
    up = unit(np.cross(inner(place, 1), inner(place) - EYE_CENTRE))
    up *= np.sign(up[:, 1:2])
    above = inner(place) + 0.7 * WET_WIDTH * width[:, None] * up
    on_ball = EYE_CENTRE + (EYE_RADIUS - 0.05) * unit(above - EYE_CENTRE)
    shares = np.repeat(np.linspace(0.0, 1.0, WET_ROWS), WET_COLUMNS)
    share = shares.reshape(WET_ROWS, WET_COLUMNS, 1)
    hollow = 0.88 * share * (1.0 - share)
    flat = (1.0 - share) * on_lid + share * on_ball
    vertices = ((1.0 - hollow) * flat + hollow * inner(place)).reshape(-1, 3)
    faces = grid_faces(WET_ROWS, WET_COLUMNS)
    colours = mix(WET_DARK, WET_LIGHT, smooth_step(0.0, 1.0, shares))
    left = Solid(vertices, faces, colours, np.arange(len(vertices), dtype=np.int32))
    return joined([left.mirrored(), left])
