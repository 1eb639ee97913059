"""Five closed rows of vertices around the left eye, from behind the lid out to its crease.

Row 0 is tucked behind the lid and is the boundary of the skin; 1 and 2 are the inner and outer
edge of the lid margin; 3 lies on the lid; 4 in the crease above and the furrow below.
Columns run from the inner corner (0) over the upper lid to the outer corner (COLUMNS / 2) and back
along the lower lid.
"""

import numpy as np

from .fields import Points, Values, normals, project, smooth_maximum, unit
from .form import EYE_CENTRE, EYE_RADIUS, distance

COLUMNS = 20  # chosen: 3 mm edges along the margin
INNER_CORNER = np.array([16.2, -1.9])  # [mm] x, y of the commissure
OUTER_CORNER = np.array([43.9, 0.9])
UPPER_RISE = (
    4.95  # [mm] of the upper margin above the line between the corners: it covers some iris
)
LOWER_DROP = 5.2
CORNER_DEPTHS = (78.6, 73.4)  # [mm] z of the margin at the inner and the outer corner
MARGIN_CLEARANCE = 0.25  # [mm] between eyeball and inner edge: touching would flicker
MARGIN_THICKNESS = 1.9  # [mm] inner to outer edge
# [mm] that the outer edge is away from the inner one in front view: at the corners, and less in the
# middle of the upper lid, whose margin faces down, and of the lower one.
MARGIN_WIDTHS = (1.1, 0.8, 1.3)
# Rows on the lid: distance from the margin in its middle, at its inner and its outer corner [mm],
# and rounds of smoothing, which draw in the corners: hence the large distances there.
LID_ROWS = ((2.5, 3.2, 5.6, 1), (5.6, 6.4, 12.0, 2))
CREASE_DEPTH = 1.5  # [mm] chosen: a line that shading shows, and skin to unroll in a blink


def margin_curve(parameter: Values) -> Points:
    """The almond in front view: parameter 0..0.5 upper lid, 0.5..1 back along the lower lid."""
    parameter = np.asarray(parameter) % 1.0
    is_upper = parameter < 0.5
    way = np.where(is_upper, parameter, 1.0 - parameter) * 2.0
    along = way - 0.02 * np.sin(2.0 * np.pi * way)
    rise = UPPER_RISE * np.sin(np.pi * along**0.88) ** 0.92
    drop = -LOWER_DROP * np.sin(np.pi * np.minimum(along, 1.0) ** 1.2)
    curve: Points = INNER_CORNER + (OUTER_CORNER - INNER_CORNER) * along[:, None]
    curve[:, 1] += np.where(is_upper, rise, drop)
    return curve


def margin_depth(curve: Points, clearance: float) -> Values:
    """Depth z of a point of the lid margin: on the eyeball, but never behind its corners."""
    offset = curve - EYE_CENTRE[:2]
    radius = EYE_RADIUS + clearance
    on_ball = EYE_CENTRE[2] + np.sqrt(np.maximum(radius**2 - (offset**2).sum(axis=1), 0.0))
    width = OUTER_CORNER[0] - INNER_CORNER[0]
    across = np.clip((curve[:, 0] - INNER_CORNER[0]) / width, 0.0, 1.0)
    at_corners = CORNER_DEPTHS[0] + (CORNER_DEPTHS[1] - CORNER_DEPTHS[0]) * across
    return smooth_maximum(on_ball, at_corners + 0.6 * (clearance - MARGIN_CLEARANCE), 2.0)


def column_parameters() -> Values:
    """Curve parameters of the columns, equally spaced along each lid in space."""
    parts = []
    for start, end in ((0.0, 0.5), (0.5, 1.0)):
        dense = np.linspace(start + 1e-6, end - 1e-6, 300)
        curve = margin_curve(dense)
        line = np.column_stack([curve, margin_depth(curve, 1.4)])
        length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
        parts.append(np.interp(np.linspace(0.0, length[-1], COLUMNS // 2 + 1)[:-1], length, dense))
    parameters = np.concatenate(parts)
    parameters[0], parameters[COLUMNS // 2] = 0.0, 0.5
    return parameters


def _outward(curve: Points) -> Points:
    tangent = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    return unit(normal)


def _smoothed(row: Points) -> Points:
    return 0.5 * row + 0.25 * (np.roll(row, 1, axis=0) + np.roll(row, -1, axis=0))


def _march(row: Points, directions: Points, lengths: Values) -> Points:
    """Walk over the surface: spacing is then right in space even where it turns away."""
    for _ in range(6):
        normal = normals(distance, row)
        along = directions - (directions * normal).sum(axis=1, keepdims=True) * normal
        row = project(distance, row + unit(along) * lengths[:, None] / 6.0, rounds=2)
    return row


def _tucked_row(curve: Points) -> Points:
    centre = EYE_CENTRE[:2] - np.array([0.6, 0.0])
    behind = centre + (curve - centre) * [0.82, 0.84]
    at_inner_corner = np.exp(-(((curve[:, 0] - INNER_CORNER[0]) / 3.0) ** 2))
    depth = margin_depth(curve, MARGIN_CLEARANCE) - 3.2 + 1.9 * at_inner_corner
    return np.column_stack([behind, depth])


def eye_rows() -> list[Points]:
    """Return the five rows of the left eye, each of shape (COLUMNS, 3)."""
    parameters = column_parameters()
    curve = margin_curve(parameters)
    outward = _outward(curve)
    outer_side = np.where(parameters < 0.5, parameters, 1.0 - parameters) * 2.0
    middle = np.sin(np.pi * outer_side)
    at_corner, upper, lower = MARGIN_WIDTHS
    width = at_corner + (np.where(parameters < 0.5, upper, lower) - at_corner) * middle**0.5
    outer = curve + outward * width[:, None]
    clearance = MARGIN_CLEARANCE + MARGIN_THICKNESS
    rows = [
        _tucked_row(curve),
        np.column_stack([curve, margin_depth(curve, MARGIN_CLEARANCE)]),
        np.column_stack([outer, margin_depth(outer, clearance)]),
    ]
    ahead = np.column_stack([_smoothed(outward), np.zeros(COLUMNS)])
    for at_middle, at_inner, at_outer, rounds in LID_ROWS:
        beside = at_inner + (at_outer - at_inner) * outer_side
        row = _march(rows[2], ahead, beside + (at_middle - beside) * middle)
        for _ in range(rounds):
            row = project(distance, _smoothed(row), rounds=2)
        rows.append(row)
    rows[4] = rows[4] - normals(distance, rows[4]) * _crease_depth(parameters)[:, None]
    return rows


def _crease_depth(parameters: Values) -> Values:
    """How far the outermost row is pulled in [mm]: the fold above the upper lid."""
    upper = np.where(parameters < 0.5, np.sin(np.pi * np.minimum(parameters, 0.5) * 2.0), 0.0)
    return CREASE_DEPTH * np.maximum(upper, 0.0) ** 1.3
