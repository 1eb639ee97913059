"""What stands on the lids' edges and moves with them: lashes, and the wet edge above the lower lid.

A lash is a thin cone with three sides that leaves the lid's front edge forward and curls away from
the eye. The wet edge is a hollow strip of tears between the lower lid and the eyeball: wherever the
lamp is, some of it shines.

Sizes: lashes of the upper lid are 8 to 12 mm long, of the lower lid 6 to 8 mm; here shorter, for
the longest alone are that long. Fewer and thicker than in life, as they cling together: tips of
neighbours lean toward each other, and between such tufts there is a gap.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy

from .eye_rows import COLUMNS, eye_rows
from .fields import Points, Values, smooth_step, unit
from .form import EYE_CENTRE, EYE_RADIUS
from .solids import Colour, Solid, grid_faces, joined, mix

UPPER_COUNT, LOWER_COUNT = 50, 22
UPPER_LENGTH, LOWER_LENGTH = 6.8, 2.1  # [mm] of the longest
# Length over 0 (inner corner) to 1 (outer corner), as a share of the longest: that is further out.
UPPER_SHARES = ((0.15, 0.42), (0.35, 0.70), (0.60, 0.92), (0.80, 1.0), (1.0, 0.66))
LOWER_SHARES = ((0.25, 0.40), (0.50, 0.72), (0.80, 1.0), (1.0, 0.70))
TUFT = (2, 4)  # lashes in a tuft, fewest and most
CLINGING = 0.55  # how far the tips of a tuft come together, as a share
THICKNESS = 0.06  # [mm] half of it, at the root
PLACES = (0.0, 0.3, 0.65)  # of a lash's three rings; its tip is 1
ROOT_DEPTH = 0.25  # [mm] of roots below the skin
UPPER_ENDS, LOWER_ENDS = (0.16, 0.985), (0.30, 0.975)  # of the lid, between which lashes stand
UPPER_COLOUR, LOWER_COLOUR = (0.12, 0.085, 0.068), (0.25, 0.175, 0.14)  # these are finer
WET_COLUMNS, WET_WIDTH, WET_ROWS = 19, 0.45, 3  # [mm] of the wet edge on the lid
WET_ENDS = (0.19, 0.95)  # of the lid: beyond them it leaves the eyeball
WIDE = 0.6  # of the greatest width: where it is less, the wet edge draws back to the lid
WET_LIGHT, WET_DARK = (0.86, 0.74, 0.71), (0.78, 0.55, 0.51)  # on the eyeball, and on the lid
SEED = 7


def _edges(*, upper: bool) -> tuple[scipy.interpolate.CubicSpline, scipy.interpolate.CubicSpline]:
    """Inner and outer edge of a lid's margin over 0 (inner corner) to 1 (outer corner)."""
    half = COLUMNS // 2
    columns = np.arange(half + 1) if upper else -np.arange(half + 1) % COLUMNS
    place = np.linspace(0.0, 1.0, half + 1)
    _, inner, outer, *_ = eye_rows()
    return scipy.interpolate.CubicSpline(place, inner[columns]), scipy.interpolate.CubicSpline(
        place, outer[columns]
    )


def _row_of_lashes(count: int, longest: float, *, upper: bool) -> Solid:
    """The lashes of one lid, each rooted in its first vertex."""
    random = np.random.default_rng(SEED + upper)
    inner, outer = _edges(upper=upper)
    first, last = UPPER_ENDS if upper else LOWER_ENDS
    shares = np.array(UPPER_SHARES if upper else LOWER_SHARES).T
    places = first + (last - first) * (np.arange(count) + random.uniform(0.1, 0.9, count)) / count
    colour = UPPER_COLOUR if upper else LOWER_COLOUR
    solids: list[Solid] = []
    for place, middle in zip(places, _tufts(places, random), strict=True):
        length = longest * np.interp(place, *shares) * random.uniform(0.6, 1.0)
        # Fanned out: near the corners they lean to the side; in a tuft toward its middle.
        gap = np.linalg.norm(outer(middle) - outer(place)) * np.sign(middle - place)
        lean = 0.95 * (place - 0.36) + CLINGING * gap / length + random.normal(0.0, 0.09)
        line = _lash(inner, outer, place, (length, lean), random, upper=upper)
        solids.append(_cone(line, colour))
    return joined(solids)


def _tufts(places: Values, random: np.random.Generator) -> Values:
    """The middle of the tuft to which each lash belongs, shape (n,)."""
    sizes = random.integers(TUFT[0], TUFT[1] + 1, len(places))
    ends = np.minimum(np.cumsum(sizes), len(places))
    middles = [places[start:end].mean() for start, end in pairwise([0, *np.unique(ends)])]
    return np.repeat(middles, np.diff([0, *np.unique(ends)]))


def _lash(
    inner: scipy.interpolate.CubicSpline, outer: scipy.interpolate.CubicSpline, place: float,
    size: tuple[float, float], random: np.random.Generator, *, upper: bool,
) -> Points:  # fmt: skip
    """The middle line of a lash, shape (4, 3); size: its length [mm] and lean to the side."""
    length, lean = size
    root = outer(place) - 0.3 * random.uniform(0.0, 1.0) * (outer(place) - inner(place))
    ahead = unit((root - EYE_CENTRE)[None])[0]
    along = unit(outer(place, 1)[None])[0]
    away = np.cross(ahead, along) * (1.0 if upper else -1.0)
    away = unit((away if away[1] * (1.0 if upper else -1.0) > 0.0 else -away)[None])[0]
    first, last = (-0.35, 1.15) if upper else (0.15, 0.95)
    at, line = root - ROOT_DEPTH * ahead, []
    steps = np.linspace(0.0, 1.0, 13)
    for low, high in pairwise(steps):
        line.append(at)
        curl = first + (last - first) * 0.5 * (low + high) + random.normal(0.0, 0.02)
        step = np.cos(curl) * ahead + np.sin(curl) * away + lean * along
        at = at + (high - low) * length * unit(step[None])[0]
    line.append(at)
    return np.array(line)[[round(12 * share) for share in (*PLACES, 1.0)]]


def _cone(line: Points, colour: Colour) -> Solid:
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
    return Solid(vertices, faces, np.tile(colour, (len(vertices), 1)), roots)


def lashes() -> Solid:
    """The lashes of both eyes."""
    upper = _row_of_lashes(UPPER_COUNT, UPPER_LENGTH, upper=True)
    lower = _row_of_lashes(LOWER_COUNT, LOWER_LENGTH, upper=False)
    left = joined([upper, lower])
    return joined([left.mirrored(), left])


def wet_edges() -> Solid:
    """The tears along both lower lids; each vertex moves with the skin where it is itself."""
    inner, outer = _edges(upper=False)
    place = np.linspace(*WET_ENDS, WET_COLUMNS)
    width: Values = np.sin(np.pi * np.linspace(0.01, 0.99, WET_COLUMNS)) ** 0.8
    on_lid = inner(place) + WET_WIDTH * width[:, None] * unit(outer(place) - inner(place))
    up = unit(np.cross(inner(place, 1), inner(place) - EYE_CENTRE))
    up *= np.sign(up[:, 1:2])
    above = inner(place) + 0.7 * WET_WIDTH * width[:, None] * up
    on_ball = EYE_CENTRE + (EYE_RADIUS - 0.05) * unit(above - EYE_CENTRE)
    # At its ends it lies on the lid alone: on other heads the ball is not where it is here.
    reaching = smooth_step(0.0, WIDE, width)
    on_ball = inner(place) + reaching[:, None] * (on_ball - inner(place))
    shares = np.repeat(np.linspace(0.0, 1.0, WET_ROWS), WET_COLUMNS)
    share = shares.reshape(WET_ROWS, WET_COLUMNS, 1)
    hollow = 0.88 * share * (1.0 - share)
    flat = (1.0 - share) * on_lid + share * on_ball
    vertices = ((1.0 - hollow) * flat + hollow * inner(place)).reshape(-1, 3)
    faces = grid_faces(WET_ROWS, WET_COLUMNS)
    colours = mix(WET_DARK, WET_LIGHT, smooth_step(0.0, 1.0, shares) * np.tile(reaching, WET_ROWS))
    left = Solid(vertices, faces, colours, np.arange(len(vertices), dtype=np.int32))
    return joined([left.mirrored(), left])
