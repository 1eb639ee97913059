"""Find eyeballs in a user's file: pieces that are balls, and sockets that enclose a ball.

A head of few triangles often has neither; then only the lids give the position of the eyeball
(organs.py).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...geometry.arrays import Floats64

FEWEST_VERTICES = 4  # fewest vertices of an eyeball; smaller pieces are strands or cards of hair


def is_eyeball(points: Floats64, centre: Floats64, radius: float) -> bool:
    """Whether a piece (n, 3) is an eyeball near `centre`, or a layer of one (iris, cornea).

    centre, radius: an estimate of the eyeball [mm].
    """
    if len(points) < FEWEST_VERTICES:
        return False
    low = points.min(axis=0)
    high = points.max(axis=0)
    width, height, depth = high - low
    aside = np.abs(0.5 * (low + high) - centre)[:2].max()
    is_round = 0.6 < (width + 1e-9) / (height + 1e-9) < 1.7
    # Most pieces of a file with thousands of strands of hair end here, before the costly tests.
    if aside >= 0.4 * radius or not is_round or width <= 0.3 * radius:
        return False
    off = np.linalg.norm(points - centre, axis=1)
    if np.quantile(off, 0.9) <= 1.7 * radius:
        return True
    # Some makers' eyeballs are half as large again as those of people, and lie farther back.
    is_ball = sphere_of(points, centre, radius)[0] is not centre
    return bool(is_ball and depth >= 0.5 * width)


def sphere_of(points: Floats64, centre: Floats64, radius: float) -> tuple[Floats64, float]:
    """Fit a sphere to points (n, 3); return its centre and its radius [mm].

    If the points form no ball near the given sphere, its centre and radius are returned. The
    fit is linear: least squares of |p|^2 = 2 p c + (r^2 - |c|^2).
    """
    local = points - centre
    matrix = np.column_stack([2.0 * local, np.ones(len(local))])
    squares = (local**2).sum(axis=1)
    found, _, rank, _ = np.linalg.lstsq(matrix, squares, rcond=None)
    shift = found[:3]
    squared_radius = float(found[3] + shift @ shift)
    if rank < 4 or squared_radius <= 0.0:
        return centre, radius
    middle = centre + shift
    fitted = float(np.sqrt(squared_radius))
    off = np.abs(np.linalg.norm(points - middle, axis=1) - fitted)
    # A whole ball is an eyeball even if it is much larger, as of infants in millimetres of adults.
    narrowest = np.ptp(points, axis=0).min()
    is_whole = off.mean() < 0.03 * fitted and narrowest > 1.8 * fitted
    most_ratio = 2.6 if is_whole else 1.7
    is_ball = off.mean() < 0.12 * fitted and 0.6 < fitted / radius < most_ratio
    # The lids hide how far back a larger ball reaches.
    is_near = np.linalg.norm(middle - centre) < 0.6 * radius + max(fitted - radius, 0.0)
    return (middle, fitted) if is_ball and is_near else (centre, radius)


def ball_of_pieces(
    pieces: Sequence[Floats64], centre: Floats64, radius: float, lids: Floats64
) -> tuple[Floats64, float] | None:
    """Find centre and radius [mm] of the largest eyeball among pieces (n, 3), or None.

    centre, radius: an estimate. lids: landmarks of the eye [mm], (6, 3); a ball that protrudes
    between them is not an eyeball.
    """
    found = None
    for points in pieces:
        if not is_eyeball(points, centre, radius):
            continue
        middle, size = sphere_of(points, centre, radius)
        is_fitted = middle is not centre
        most_out = 1.5  # [mm] that the edge of a lid may lie inside the ball
        is_behind = np.linalg.norm(lids - middle, axis=1).min() > size - most_out
        if is_fitted and is_behind and (found is None or size > found[1]):
            found = middle, size
    return found


def ball_of_socket(
    skin: Floats64, outward: Floats64, centre: Floats64, radius: float
) -> tuple[Floats64, float] | None:
    """Find centre and radius [mm] of the ball in a socket behind the lids; None without socket.

    skin: vertices [mm], (V, 3). outward: cosine between each vertex normal and the direction from
    `centre` to the vertex, (V,). centre, radius: an estimate of the ball [mm].
    """
    most_radii = 2.0  # greatest distance of the socket from the centre, in radii of the ball
    facing = -0.6  # cosine below which skin faces the ball
    away = np.linalg.norm(skin - centre, axis=1)
    shell = skin[(away < most_radii * radius) & (outward < facing)]
    is_rear = shell[:, 2] < centre[2] - 0.5 * radius
    if is_rear.sum() < FEWEST_VERTICES * FEWEST_VERTICES or is_rear.all():
        return None
    middle, _ = sphere_of(shell, centre, radius)
    if middle is centre:
        return None
    thickness = 0.3  # [mm] between the ball and its socket
    nearest = np.quantile(np.linalg.norm(shell - middle, axis=1), 0.1)
    return middle, float(nearest) - thickness
