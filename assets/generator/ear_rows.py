"""Rows of vertices that make the left ear, from its root on the head to the floor of the concha.

Row 0 is the root, a hole in the infill; row 1 the free edge of the helix; 2 the crest where the
helix rolls forward; 3 the hollow inside it (the scapha); 4 the ridge around the concha (antihelix,
antitragus, tragus), which two deep vertices close. Columns run from the root of the helix over the
top, down the back to the lobe, and up again in front of the tragus. In front the ear has no back
side: there some rows fall onto the root, and the mesh has triangles instead of quadrilaterals.

The ear is drawn in its own plane: `back` from its front line, `up` from the tragus, `out` from the
plane [mm]. Size and place are chosen by eye, not after a table: 62 by 33 mm, the top at the height
of the brow, the lobe at that of the base of the nose.
"""

import numpy as np

from .fields import Points, Values, cast
from .form import distance

TRAGUS_HEIGHT, TRAGUS_DEPTH = -13.0, -4.0  # [mm] y and z of the front line at the tragus
TILT_DEG = 12.0  # the top lies further back
STAND_OFF_DEG = ((-30.0, 12.0), (-15.0, 20.0), (5.0, 27.0), (30.0, 30.0))  # up [mm], angle
MIDDLE = np.array([14.0, 3.0])  # back, up [mm]: the rows of the helix shrink toward it
CONCHA = np.array([[12.3, 6.0], [10.2, -7.5]])

# back, up [mm] of every column
ROOT = (
    (-2.0, 15.5), (3.8, 19.3), (9.0, 22.3), (14.5, 20.8), (18.0, 16.2), (19.5, 10.0),
    (19.1, 3.5), (17.5, -3.0), (15.6, -9.5), (13.2, -15.5), (10.6, -20.2), (6.6, -23.0),
    (2.0, -22.4), (-2.5, -19.5), (-3.5, -8.5), (-3.2, 4.0),
)  # fmt: skip
EDGE = (
    (-2.0, 15.5), (1.6, 26.0), (8.2, 32.4), (16.6, 34.4), (24.6, 31.6), (30.4, 24.6),
    (32.8, 14.8), (32.0, 4.4), (29.0, -5.6), (24.6, -15.4), (19.6, -24.6), (12.0, -29.8),
    (4.6, -28.6), (-2.5, -19.5), (-3.5, -8.5), (-3.2, 4.0),
)  # fmt: skip
CONCHA_RIDGE = (
    (4.8, 9.0), (8.0, 14.0), (12.0, 16.5), (16.0, 15.5), (19.0, 12.0), (20.7, 7.3),
    (20.8, 1.5), (19.3, -4.5), (17.2, -9.6), (14.8, -13.6), (11.6, -16.4), (8.0, -17.0),
    (5.0, -15.2), (3.4, -11.0), (4.8, -4.8), (2.8, 2.2),
)  # fmt: skip
COLUMNS, ROWS = len(ROOT), 5
ON_ROOT = (0, 13, 14, 15)  # columns whose free edge is the root
CREST_SHRINK, HOLLOW_SHRINK = 0.84, 0.69
EDGE_OUT = -0.4
CREST_OUT = (0, 2.8, 3.6, 3.8, 3.6, 3.3, 2.9, 2.4, 1.8, 1.5, 1.5, 1.6, 1.7, 0, 0, 0)
HOLLOW_OUT = (2.2, -1.6, -3.0, -3.2, -3.2, -3.0, -2.6, -1.8, -0.6, 0.8, 1.5, 2.1, 2.2, 2.0, 0, 0)
RIDGE_OUT = (0.8, -1.6, -1.0, 1.6, 3.6, 4.6, 4.8, 4.4, 3.9, 3.6, 3.9, 3.4, 2.0, 3.0, 6.4, 3.8)
CONCHA_OUT = (-6.5, -8.5)
TO_LOWER_FLOOR = range(6, 14)  # columns that the lower vertex of the floor is joined to


def _plane_axes() -> tuple[Points, Points]:
    """Unit vectors along the ear, up, and in the side view backward."""
    tilt = np.radians(TILT_DEG)
    up = np.array([0.0, np.cos(tilt), -np.sin(tilt)])
    return up, np.array([0.0, -np.sin(tilt), -np.cos(tilt)])


def _on_head(back: Values, up: Values) -> Points:
    """Where rays from the side meet the head, at places in the side view, shape (n, 3)."""
    up_axis, back_axis = _plane_axes()
    start = np.array([110.0, TRAGUS_HEIGHT, TRAGUS_DEPTH])
    origins = start + up[:, None] * up_axis + back[:, None] * back_axis
    return cast(distance, origins, np.tile([-1.0, 0.0, 0.0], (len(up), 1)), reach=90.0)


def _place(flat: Points, out: Values) -> Points:
    """Points of the ear from its plane to the head; the plane is hinged on its front line."""
    back, up = flat.T
    _, back_axis = _plane_axes()
    angle = np.radians(np.interp(up, *np.array(STAND_OFF_DEG).T))[:, None]
    outward = np.array([1.0, 0.0, 0.0])
    hinge = _on_head(np.zeros(len(up)), up)
    backward = np.cos(angle) * back_axis + np.sin(angle) * outward
    normal = np.cos(angle) * outward - np.sin(angle) * back_axis
    placed: Points = hinge + back[:, None] * backward + out[:, None] * normal
    return placed


def ear_root() -> Points:
    """Row 0, on the head, shape (COLUMNS, 3)."""
    return _on_head(*np.array(ROOT).T)


def ear_rows() -> tuple[list[Points], Points]:
    """Rows 1 to 4, each of shape (COLUMNS, 3), and the floor of the concha, shape (2, 3)."""
    edge, ridge = np.array(EDGE), np.array(CONCHA_RIDGE)
    crest = MIDDLE + CREST_SHRINK * (edge - MIDDLE)
    hollow = MIDDLE + HOLLOW_SHRINK * (edge - MIDDLE)
    in_front = np.array(ON_ROOT)
    hollow[in_front] = 0.5 * (edge[in_front] + ridge[in_front])
    rows = [
        _place(edge, np.full(COLUMNS, EDGE_OUT)),
        _place(crest, np.array(CREST_OUT, dtype=np.float64)),
        _place(hollow, np.array(HOLLOW_OUT, dtype=np.float64)),
        _place(ridge, np.array(RIDGE_OUT, dtype=np.float64)),
    ]
    return rows, _place(CONCHA, np.array(CONCHA_OUT))


def merged_columns() -> list[tuple[int, ...]]:
    """For rows 1 to 4: the columns whose vertex is that of the row before."""
    return [ON_ROOT, ON_ROOT, (14, 15), ()]


def face_count() -> int:
    """How many triangles the rows and the floor of the concha have."""
    merged: list[set[int]] = [set(), *map(set, merged_columns())]
    quads = 0
    for row in range(1, len(merged)):
        for column in range(COLUMNS):
            following = (column + 1) % COLUMNS
            quads += 2 - (column in merged[row]) - (following in merged[row])
    return quads + COLUMNS + 2


def floor_faces(ridge: list[int], upper: int, lower: int) -> list[list[int]]:
    """The floor of the concha: two fans within the ridge, and what lies between them."""
    faces = []
    for column, first in enumerate(ridge):
        following = (column + 1) % COLUMNS
        own, other = ((upper, lower)[place in TO_LOWER_FLOOR] for place in (column, following))
        faces.append([first, own, ridge[following]])
        if own != other:
            faces.append([ridge[following], own, other])
    return faces
