"""Tongue and oral cavity: what must be dark, and what must be seen in front of it.

The cavity is two shells that open with the mouth like a clam: palate, cheeks and throat belong to
the cranium, the floor to the mandible. The lining of the cheeks runs outside both rows of teeth
from the throat to the corners of the mouth and hangs down far enough that no gap opens with the
jaw; behind the corners only its inner side is drawn, so that it cannot come before the lips.
"""

import numpy as np
import scipy

from .ambient import REDDENING, in_mouth_light
from .fields import Points, smooth_step
from .solids import Solid, grid_faces, joined, mix, welded

PALATE, CHEEK, FLOOR = (0.78, 0.44, 0.42), (0.88, 0.45, 0.42), (0.70, 0.36, 0.34)
TONGUE, TONGUE_ROOT = (0.83, 0.53, 0.52), (0.72, 0.40, 0.39)
TONGUE_RINGS, TONGUE_AROUND = 24, 28  # fine enough for its rim when it is out
CENTRE = np.array([0.0, -66.0, 56.0])  # [mm]
HALF_WIDTH, ROOF, FRONT, BACK = 30.0, 17.0, 29.0, 38.0  # [mm]; FRONT ends inside the gums
FRONT_RISE, FRONT_FROM_DEG = 8.0, 100.0  # the roof ends above the upper gums

# The lining from the middle of the throat to the left corner of the mouth: x, z, height of the
# upper and of the lower end [mm].
LINING = (
    (0, 18, -50, -108), (15, 21, -48, -108), (26, 30, -47, -107), (32.5, 42, -47, -105),
    (35.5, 54, -48, -101), (36, 65, -50, -95), (33, 75, -53, -88), (28, 82, -57, -80),
    (24, 85.5, -60, -73),
)  # fmt: skip
LINING_COLUMNS, LINING_ROWS = 17, 6
COVERED = 0.3  # chosen: of the light, what teeth and lips keep from the lining beside them


def _outline(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Relative x and z of the cavity seen from above; angle 0 is straight back."""
    x = HALF_WIDTH * np.sin(angle)
    z = np.where(np.cos(angle) > 0, -BACK, -FRONT) * np.cos(angle)
    return x, z


def _lit(points: Points, colour: tuple[float, float, float]) -> Points:
    return in_mouth_light(points, np.tile(colour, (len(points), 1)))


def _lining() -> Solid:
    """The inner side of both cheeks and of the throat."""
    table = np.array(LINING, dtype=np.float64)
    steps = np.linalg.norm(np.diff(table[:, :2], axis=0), axis=1)
    curve = scipy.interpolate.PchipInterpolator(np.r_[0.0, np.cumsum(steps)], table)
    left = curve(np.linspace(0.0, steps.sum(), LINING_COLUMNS))
    whole = np.vstack([left[:0:-1] * [-1.0, 1.0, 1.0, 1.0], left])
    rows = []
    for level in np.linspace(0.0, 1.0, LINING_ROWS):
        bulge = 1.0 - 0.10 * (2.0 * level - 1.0) ** 2  # hollow between its upper and lower end
        height = whole[:, 2] + (whole[:, 3] - whole[:, 2]) * level
        rows.append(np.column_stack([whole[:, 0] * bulge, height, whole[:, 1]]))
    wall = np.vstack(rows)
    covered = 1.0 - COVERED * smooth_step(10.0, 30.0, np.abs(wall[:, 0]))
    colours = _lit(wall, CHEEK) * covered[:, None] ** np.array(REDDENING)
    return Solid(wall, grid_faces(LINING_ROWS, len(whole))[:, ::-1], colours)


def upper_cavity() -> Solid:
    """Return palate, cheeks and throat, visible from inside."""
    angle = np.radians(np.linspace(-180.0, 180.0, 37))
    x, z = _outline(angle)
    rows = []
    for level in np.linspace(0.0, 1.0, 7):
        wide, high = np.sin(level * np.pi / 2) ** 0.8, np.cos(level * np.pi / 2)
        in_front = np.abs(angle) > np.radians(FRONT_FROM_DEG)
        least = np.where(in_front, FRONT_RISE, 0.0)
        rows.append(np.column_stack([x * wide, np.maximum(ROOF * high, least), z * wide]))
    dome = CENTRE + np.vstack(rows)
    roof = Solid(dome, grid_faces(7, len(angle))[:, ::-1], _lit(dome, PALATE))
    return welded(joined([roof, _lining()]))


def lower_cavity() -> Solid:
    """Return the floor under the tongue, visible from above."""
    angle = np.radians(np.linspace(-180.0, 180.0, 33))
    x, z = _outline(angle)
    rows = []
    for level in np.linspace(0.0, 1.0, 6):
        rise = 9.0 * level**3
        depth = np.where(z < 0, 0.62, 0.9) * z * level  # ends well in front of the neck
        rows.append(np.column_stack([0.82 * x * level, np.full(len(x), -22.0) + rise, depth]))
    floor = CENTRE + np.vstack(rows)
    return welded(Solid(floor, grid_faces(6, len(angle)), _lit(floor, FLOOR)))


def tongue() -> Solid:
    """Return the resting tongue, its tip behind the lower incisors."""
    lengthwise = np.linspace(0.0, 1.0, TONGUE_RINGS) ** 1.6  # tip to root, closest at the tip
    around = 2.0 * np.pi * np.arange(TONGUE_AROUND) / TONGUE_AROUND
    rows, roots = [], []
    for way in lengthwise:
        swell = np.sqrt(1.0 - (1.0 - min(way / 0.55, 1.0)) ** 2)
        half_width = 18.5 * (1.0 - (1.0 - min(way / 0.75, 1.0)) ** 2) ** 0.38
        height = 10.0 * swell
        centre_y = -78.0 + 4.0 * np.sin(np.pi * min(way, 0.8)) - 5.0 * max(way - 0.6, 0.0)
        centre_z = 83.0 - 50.0 * way
        x = half_width * np.sign(np.cos(around)) * np.abs(np.cos(around)) ** 0.75
        y = height * np.sign(np.sin(around)) * np.abs(np.sin(around)) ** 0.75
        y = y - 1.4 * np.exp(-((x / 4.5) ** 2)) * (y > 0) * swell  # the groove in the middle
        rows.append(np.column_stack([x, centre_y + y, np.full(len(x), centre_z)]))
        roots.append(np.full(len(x), way))
    vertices = np.vstack(rows)
    colours = mix(TONGUE, TONGUE_ROOT, smooth_step(0.15, 0.85, np.concatenate(roots)))
    hollow = 0.88 + 0.12 * smooth_step(0.0, 5.0, np.abs(vertices[:, 0]))
    colours = in_mouth_light(vertices, colours * hollow[:, None])
    faces = grid_faces(len(lengthwise), TONGUE_AROUND, wrapped=True)[:, ::-1]
    return welded(Solid(vertices, faces, colours))
