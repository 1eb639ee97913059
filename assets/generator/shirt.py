"""A plain shirt: it covers the edge of the neck, and lets the shoulders begin.

The foot of the neck stands still while the head turns, and so does the shirt. Its collar is wider
than the neck, which it holds at some distance; it is no part of a fitted head, which may have
shoulders of its own.
"""

import numpy as np
import scipy

from .fields import Points, Values
from .noise import noise
from .outline import rim_curve
from .solids import Solid, grid_faces, mix, welded

COLUMNS, BODY_ROWS = 52, 15
CLOTH, RIB, WITHIN = (0.245, 0.275, 0.315), (0.215, 0.242, 0.28), (0.07, 0.075, 0.085)
# Rows of the collar from within: distance from the neck, height over its edge [mm].
COLLAR = ((-12.0, -16.0), (1.6, -8.0), (2.6, 3.0), (3.5, 5.4), (4.9, 5.2), (6.2, 2.0), (9.5, -7.5))
# Rows of the body in front, at the side and behind: distance from the middle, height [mm].
FRONT = ((66, -171), (76, -184), (90, -207), (102, -240), (110, -300), (108, -425), (0, -430))
SIDE = ((72, -162), (104, -173), (150, -190), (184, -211), (202, -248), (206, -425), (0, -430))
BACK = ((84, -153), (96, -168), (112, -196), (120, -232), (124, -300), (118, -425), (0, -430))
ROUNDNESS = 0.86  # power of the sine: below 1 the chest is flatter than an ellipse
MIDDLE = -6.0  # z [mm]
FOLDS = 1.1  # [mm]


def shirt() -> Solid:
    """The shirt, seen from outside, and the inside of its collar."""
    angle = 2.0 * np.pi * np.arange(COLUMNS) / COLUMNS
    rows = [*_collar(angle), *_body(angle)]
    points = np.vstack(rows)
    ring = np.repeat(np.arange(len(rows)), COLUMNS)
    colours = mix(CLOTH, RIB, (ring <= len(COLLAR)).astype(np.float64))
    colours = mix(colours, WITHIN, np.clip((3.0 - ring) / 2.0, 0.0, 1.0))
    colours *= 1.0 + 0.05 * noise(points, 2.2, seed=52)[:, None]
    return welded(Solid(points, grid_faces(len(rows), COLUMNS, wrapped=True)[:, ::-1], colours))


def _collar(angle: Values) -> list[Points]:
    """Rows around the neck, from within over the edge to the seam, each (COLUMNS, 3)."""
    left = rim_curve()
    turned = np.arctan2(left[:, 0], left[:, 2] - MIDDLE)
    at = np.abs(np.where(angle > np.pi, angle - 2.0 * np.pi, angle))
    rim = np.stack([np.interp(at, turned[::-1], left[::-1, axis]) for axis in range(3)], axis=1)
    rim[:, 0] *= np.where(angle > np.pi, -1.0, 1.0)
    outward = np.stack([np.sin(angle), np.zeros(COLUMNS), np.cos(angle)], axis=1)
    return [rim + away * outward + [0.0, height, 0.0] for away, height in COLLAR]


def _body(angle: Values) -> list[Points]:
    """Rows from the seam of the collar over the shoulders to the closed lower end."""
    lines = [
        scipy.interpolate.PchipInterpolator(
            np.linspace(0.0, 1.0, len(line)), np.array(line, dtype=np.float64)
        )
        for line in (FRONT, SIDE, BACK)
    ]
    across = np.sign(np.sin(angle)) * np.abs(np.sin(angle)) ** ROUNDNESS
    along, share = np.cos(angle), np.sin(angle) ** 2
    rows = []
    for place in np.linspace(0.0, 1.0, BODY_ROWS):
        front, side, back = (line(place) for line in lines)
        middle = np.where(along > 0.0, front[0], back[0])
        height = np.where(along > 0.0, front[1], back[1])
        row = np.stack(
            [
                side[0] * across,
                side[1] * share + height * (1.0 - share),
                MIDDLE + middle * along,
            ],
            axis=1,
        )
        fade = np.sin(np.pi * place) * FOLDS
        row[:, 1] += fade * noise(row * [0.6, 0.6, 0.25], 16.0, seed=51)
        rows.append(row)
    return rows
