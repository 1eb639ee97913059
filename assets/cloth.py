"""A square of cloth over a ball: free folds, where the plane and the face have none.

Chosen: 24 x 24 cells are as many as keep folds some triangles wide; at 1.2 m a side the sheet
falls in a second, slowly enough to watch.
"""

import numpy as np

from .model import Cloth, Part
from .plane import make_grid

CELLS = 24  # each way
CELL = 50.0  # [mm]
RADIUS = 270.0  # [mm] of the ball: corners hang down by as much as half of it is high
ABOVE = 10.0  # [mm] from the ball up to the sheet
COLOURS = ((0.88, 0.86, 0.80), (0.72, 0.30, 0.24))  # of the ball's sectors, which show its turning
SECTORS = 12
ROWS, SEGMENTS = 48, 96  # of the ball: no corners on its outline
SHINE = 0.35


def make_cloth() -> Cloth:
    """Build the sheet, facing +y, above a ball around the origin."""
    flat, faces = make_grid(CELLS, CELLS, CELL)
    vertices = flat[:, [1, 2, 0]] + [0.0, RADIUS + ABOVE, 0.0]
    vertices.flags.writeable = False
    return Cloth(vertices, faces, make_ball(), RADIUS)


def make_ball() -> Part:
    """A ball with sectors around the y axis; triangles share no vertex, so their edges are crisp.

    A grid of longitudes and latitudes, bent round.
    """
    flat, faces = make_grid(SEGMENTS, ROWS, 1.0)
    longitude, latitude = 2.0 * np.pi * flat[:, 0] / SEGMENTS, np.pi * flat[:, 1] / ROWS
    out = np.cos(latitude)
    directions = np.stack([out * np.sin(longitude), np.sin(latitude), out * np.cos(longitude)], -1)
    corners = directions[faces].reshape(-1, 3).astype(np.float32)
    sector = np.floor(flat[faces, 0].mean(axis=1) * SECTORS / SEGMENTS).astype(int)
    colours = np.repeat(np.array(COLOURS, np.float32)[sector % 2], 3, axis=0)
    numbers = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    for array in (corners, colours, numbers):
        array.flags.writeable = False
    vertices = np.float32(RADIUS) * corners
    return Part("ball", vertices, corners, numbers, colours, bone="ball", shine=SHINE)
