"""Eight open rows of vertices around the left half of the mouth, from the vestibule outward.

Rows 0 and 1 lie behind the lips (0 is the boundary of the skin), 2 is the line where the lips
meet, 3 to 5 lie on the red, 6 on its border, 7 outside it. Columns run from the mid-plane over the
upper lip to the corner (column SIDE) and back along the lower lip.

The lips are closed but must not be welded: the lower line lies a hair behind the upper one and a
hair above it, so that nothing shows through. Loaders that merge vertices nearer than 0.3 mm would
close the mouth for good.
"""

import numpy as np

from . import lips
from .fields import Points, Values
from .form import from_front

SIDE = 7  # columns from the mid-plane to the corner, the corner itself not counted
COLUMNS = 2 * SIDE + 1
LOWER_TUCK = 0.35  # [mm] of the lower line behind the upper one
SEAM_ROW, CREST_ROW, BORDER_ROW, OUTER_ROW = 2, 3, 6, 7

# Rows on the lips: position across the lip, x of the corner [mm], least opening [mm]. Every row
# has a corner of its own, or the rows would fold over each other there.
RED_ROWS = ((0.18, 25.3, 1.6), (0.45, 26.7, 2.9), (0.72, 28.0, 4.15), (1.0, 29.4, 5.7))
SEAM_CORNER = 24.1
VESTIBULE = ((6.8, 3.2, 21.0), (3.0, 1.0, 22.8))  # depth, opening, x of the corner [mm]
OUTER_CORNER = 33.2
OUTER_DISTANCE = 4.2  # [mm]


def _columns() -> Values:
    """Relative x of the columns, a little closer toward the corner."""
    even = np.arange(SIDE) / SIDE
    return 0.48 * np.sin(even * np.pi / 2) + 0.52 * even


def _around(upper: Points, corner: Points, lower: Points) -> Points:
    return np.vstack([upper, corner, lower[::-1]])


def _row_in_front_view(across: float, corner_x: float, opening: float) -> Points:
    relative = _columns()
    x = relative * corner_x
    inside = np.minimum(x, 0.97 * lips.HALF_WIDTH)
    seam = lips.seam_height(inside)
    least = opening * np.sqrt(1 - relative**2) * np.clip(relative / 0.5, 0.0, 1.0)
    up = np.maximum(across * (lips.upper_border(inside) - seam), least)
    down = np.maximum(across * (seam - lips.lower_border(inside)), least)
    corner_y = lips.seam_height(np.array([min(corner_x, lips.HALF_WIDTH)])) - 0.15
    corner = np.array([[corner_x, corner_y[0]]])
    return _around(np.column_stack([x, seam + up]), corner, np.column_stack([x, seam - down]))


def _seam_row() -> Points:
    flat = _row_in_front_view(0.0, SEAM_CORNER, 0.0)
    relative = _columns()
    x = np.minimum(flat[: SIDE + 1, 0], SEAM_CORNER)
    upper_z = from_front(x, lips.seam_height(x))[:, 2] - 0.2
    upper_z[SIDE] -= 0.4
    lower_z = upper_z[:SIDE] - LOWER_TUCK
    row = np.column_stack([flat, np.r_[upper_z, lower_z[::-1]]])
    lift = 0.05 * np.clip((0.62 - relative) / 0.2, 0, 1) - 0.03 * np.clip(
        (relative - 0.55) / 0.2, 0, 1
    )
    row[SIDE + 1 :, 1] += lift[::-1]
    return row


def _vestibule_row(seam: Points, depth: float, opening: float, corner_x: float) -> Points:
    spread = opening * (1 - _columns() ** 3)
    row = seam.copy()
    row[:, 0] *= corner_x / SEAM_CORNER
    row[:, 1] += np.r_[spread, 0.0, -spread[::-1]]
    row[:, 2] -= depth
    return row


def _outer_row(border: Points) -> Points:
    relative = _columns()
    x = relative * OUTER_CORNER
    away = OUTER_DISTANCE * np.sqrt(1 - relative**2)
    y = border[:, 1] + np.r_[away, 0.0, -away[::-1]]
    return from_front(np.r_[x, OUTER_CORNER, x[::-1]], y)


def mouth_rows() -> list[Points]:
    """Return the eight rows of the left half, each of shape (COLUMNS, 3), ends on x = 0."""
    seam = _seam_row()
    rows = [_vestibule_row(seam, *shape) for shape in VESTIBULE]
    rows.append(seam)
    for across, corner_x, opening in RED_ROWS:
        flat = _row_in_front_view(across, corner_x, opening)
        rows.append(from_front(flat[:, 0], flat[:, 1]))
    rows.append(_outer_row(rows[BORDER_ROW]))
    for row in rows:
        row[[0, -1], 0] = 0.0
    return rows
