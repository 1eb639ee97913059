"""Points that must be vertices: landmarks, the crease around the wing of the nose, the fold below.

The nasolabial fold is a row of edges too: a smile can crease the skin only where the mesh has one;
so are the bands in which the platysma stands out on the neck, and the hollow between them.
Every point is given for the left half and put onto the surface. Names are anatomical; numbers such
as `jaw_12` are those of the iBug landmark at the point.
"""

import numpy as np

from . import nose
from .fields import Points, gradient, project
from .form import FOLD, distance, from_axis, from_front, head_distance

# Height [mm] of points in the mid-plane, from the top down.
MIDLINE_ABOVE_MOUTH = {
    "vertex": 148.0,  # capsule height: the crown
    "trichion": 64.0,
    "metopion": 47.0,
    "glabella": 21.0,
    "nasion": 6.4,
    "rhinion": -9.0,
    "supratip": -23.0,
    "pronasale": -34.6,
    "subnasale": -45.5,
}
MIDLINE_BELOW_MOUTH = {
    "sublabiale": -84.2,
    "pogonion": -98.0,
    "gnathion": -107.4,
    "menton": -109.9,
    "cervicale": -126.0,
}
# x, y [mm] in front view
FROM_FRONT = {
    "brow_22": (10.5, 18.5),
    "brow_23": (20.5, 21.6),
    "brow_24": (30.5, 23.2),
    "brow_25": (40.0, 22.0),
    "brow_26": (48.6, 17.0),
    "orbitale": (32.0, -17.5),
    "cheek": (44.0, -26.0),
    "nostril_sill": (7.6, -47.0),
    "columella_base": (3.2, -44.8),
    "frontotemporale": (52.0, 34.0),
}
# angle about the axis [deg], height [mm]
FROM_AXIS = {
    "jaw_9": (15.0, -109.0),
    "jaw_10": (31.0, -105.0),
    "jaw_11": (49.0, -98.0),
    "jaw_12": (70.0, -83.0),
    "jaw_13": (79.0, -66.0),
    "jaw_14": (86.0, -48.0),
    "jaw_15": (90.0, -29.0),
    "tragion": (95.0, -13.0),
    "zygion": (78.0, -17.0),
    "gonion": (91.0, -84.5),
    "temple": (72.0, 22.0),
}
# angle about the axis [deg], height [mm], from the jaw down: inner band, hollow, outer band
NECK_ROWS = (
    ((17.0, -129.0), (20.0, -139.0), (23.0, -149.0)),
    ((34.0, -125.5), (38.0, -136.0), (42.0, -147.0)),
    ((50.0, -122.0), (55.0, -133.0), (60.0, -144.0)),
)
# Angles around the wing of the nose [deg], from above it to below, at which its crease is sought.
CREASE_ANGLES = (62.0, 30.0, -2.0, -36.0, -72.0)
FOLD_START = 1  # the first point of the fold's curve lies on the alar crease
FOLD_ON_CREASE = 1  # and is that vertex of it
WING_CENTRE, WING_RADIUS, WING_DEPTH = (11.5, -39.0), 7.0, 97.0  # [mm] x, y; radius; z


def lateral_anchors() -> dict[str, Points]:
    """Named points of the left half beside the mid-plane, name -> (3,)."""
    from_front_xy = np.array(list(FROM_FRONT.values()), dtype=np.float64)
    front = from_front(from_front_xy[:, 0], from_front_xy[:, 1])
    polar = np.array(list(FROM_AXIS.values()), dtype=np.float64)
    side = from_axis(np.radians(polar[:, 0]), polar[:, 1])
    names = (*FROM_FRONT, *FROM_AXIS)
    return dict(zip(names, np.vstack([front, side]), strict=True))


def midline_anchors(heights: dict[str, float]) -> dict[str, Points]:
    """Named points in the mid-plane, name -> (3,)."""
    values = np.array(list(heights.values()))
    points = from_axis(np.zeros(len(values)), values)
    points[:, 0] = 0.0
    return dict(zip(heights, points, strict=True))


def nasolabial_fold() -> Points:
    """The fold from beside the alar crease past the corner of the mouth, shape (n, 3)."""
    x, y = np.array(FOLD[FOLD_START:]).T
    return from_front(x, y)


def neck_rows() -> list[Points]:
    """The bands of the platysma and the hollow between them, each of shape (n, 3)."""
    rows = (np.array(row).T for row in NECK_ROWS)
    return [from_axis(np.radians(angle), height) for angle, height in rows]


def alar_crease() -> Points:
    """The line where wing and cheek meet, from above the wing to the alar base, shape (n, 3)."""
    angle = np.radians(CREASE_ANGLES)
    points = np.column_stack(
        [
            WING_CENTRE[0] + WING_RADIUS * np.cos(angle),
            WING_CENTRE[1] + WING_RADIUS * np.sin(angle),
            np.full(len(angle), WING_DEPTH),
        ]
    )
    # Least-norm Newton steps onto the line where both surfaces pass, then out through the fillet.
    for _ in range(25):
        values = np.stack([nose.distance(points), head_distance(points)], axis=1)
        slopes = np.stack(
            [gradient(nose.distance, points), gradient(head_distance, points)], axis=1
        )
        for i in range(len(points)):
            step = np.linalg.lstsq(slopes[i], values[i], rcond=None)[0]
            points[i] -= 0.7 * step * min(1.0, 1.5 / max(float(np.linalg.norm(step)), 1e-9))
    return project(distance, points)
