"""Tongue and oral cavity: what must be dark, and what must be seen in front of it.

The cavity is two shells that open with the mouth like a clam: palate, sides and throat belong to
the cranium, the floor to the mandible. Its sides hang down where the cheeks hide them, so that no
gap opens at 20 degrees; together with the renderer's dark inner side of the skin nothing behind
the head is ever seen through the mouth.
"""

import numpy as np

from .fields import smooth_step
from .solids import Solid, grid_faces, joined, mix, welded

PALATE_FRONT, PALATE_BACK = (0.36, 0.15, 0.145), (0.06, 0.018, 0.018)
TONGUE, TONGUE_ROOT = (0.70, 0.37, 0.36), (0.25, 0.09, 0.09)
CENTRE = np.array([0.0, -66.0, 56.0])  # [mm]
HALF_WIDTH, ROOF, FRONT, BACK = 32.0, 17.0, 29.0, 38.0  # [mm]; FRONT ends inside the gums
FRONT_END_DEG, SIDE_END_DEG = 180.0, 118.0  # from straight back
THROAT_DEPTH, FRONT_DEPTH = 40.0, 8.0  # [mm] how far the sides hang below the roof's edge


def _outline(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Relative x and z of the cavity seen from above; angle 0 is straight back."""
    x = HALF_WIDTH * np.sin(angle)
    z = np.where(np.cos(angle) > 0, -BACK, -FRONT) * np.cos(angle)
    return x, z


def _shade(z: np.ndarray) -> np.ndarray:
    return mix(PALATE_BACK, PALATE_FRONT, smooth_step(35.0, 84.0, z))


def upper_cavity() -> Solid:
    """Return palate, sides and throat, visible from inside."""
    angle = np.radians(np.linspace(-FRONT_END_DEG, FRONT_END_DEG, 49))
    x, z = _outline(angle)
    rows = []
    for level in np.linspace(0.0, 1.0, 8):
        wide, high = np.sin(level * np.pi / 2) ** 0.8, np.cos(level * np.pi / 2)
        in_front = np.abs(angle) > np.radians(SIDE_END_DEG)
        least = np.where(in_front, 8.0, 0.0)  # in front the roof ends above the gum
        rows.append(np.column_stack([x * wide, np.maximum(ROOF * high, least), z * wide]))
    dome = CENTRE + np.vstack(rows)
    roof = Solid(dome, grid_faces(8, len(angle))[:, ::-1], _shade(dome[:, 2]))

    angle = np.radians(np.linspace(-SIDE_END_DEG, SIDE_END_DEG, 33))
    x, z = _outline(angle)
    forward = np.abs(angle) / np.radians(SIDE_END_DEG)
    hang = THROAT_DEPTH + (FRONT_DEPTH - THROAT_DEPTH) * smooth_step(0.45, 1.0, forward)
    rows = [
        np.column_stack([x * (1 - 0.12 * level), -hang * level, z * (1 - 0.06 * level)])
        for level in np.linspace(0.0, 1.0, 6)
    ]
    skirt = CENTRE + np.vstack(rows)
    sides = Solid(skirt, grid_faces(6, len(angle))[:, ::-1], 0.6 * _shade(skirt[:, 2]))
    return welded(joined([roof, sides]))


def lower_cavity() -> Solid:
    """Return the floor under the tongue, visible from above."""
    angle = np.radians(np.linspace(-180.0, 180.0, 41))
    x, z = _outline(angle)
    rows = []
    for level in np.linspace(0.0, 1.0, 7):
        rise = 9.0 * level**3
        depth = np.where(z < 0, 0.62, 0.9) * z * level  # ends well in front of the neck
        rows.append(np.column_stack([0.82 * x * level, np.full(len(x), -22.0) + rise, depth]))
    floor = CENTRE + np.vstack(rows)
    faces = grid_faces(7, len(angle))
    return welded(Solid(floor, faces, 0.7 * _shade(floor[:, 2])))


def tongue() -> Solid:
    """Return the resting tongue, its tip behind the lower incisors."""
    lengthwise = np.linspace(0.0, 1.0, 19)  # tip to root
    around = 2.0 * np.pi * np.arange(24) / 24
    rows, roots = [], []
    for way in lengthwise:
        swell = np.sqrt(1.0 - (1.0 - min(way / 0.55, 1.0)) ** 2) if way > 0 else 0.03
        half_width = 18.5 * max(swell, 0.03)
        height = 10.0 * max(swell, 0.03)
        centre_y = -78.5 + 5.0 * np.sin(np.pi * min(way, 0.8)) - 5.0 * max(way - 0.6, 0.0)
        centre_z = 83.0 - 50.0 * way
        x = half_width * np.cos(around)
        y = height * np.sin(around)
        y = y - 1.6 * np.exp(-((x / 3.0) ** 2)) * (y > 0) * swell  # the groove in the middle
        rows.append(np.column_stack([x, centre_y + y, np.full(len(x), centre_z)]))
        roots.append(np.full(len(x), way))
    vertices = np.vstack(rows)
    colours = mix(TONGUE, TONGUE_ROOT, smooth_step(0.15, 0.85, np.concatenate(roots)))
    return Solid(vertices, grid_faces(len(lengthwise), 24, wrapped=True)[:, ::-1], colours)
