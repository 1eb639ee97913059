"""Two flat sheets: the paper's second test case, and a square of cloth over a ball.

The plane has 7 x 11 cells. Source: Kähler et al. 2003, Figure 9 and Table 1 ("plane", 154
triangles). 154 = 2 * 7 * 11 is the only way to write the count as a grid of halved cells that is
about as wide as the figure shows.

The cloth makes free folds, where the plane and the face have none. Chosen: 24 x 24 cells are as
many as keep folds some triangles wide; at 1.2 m a side it falls in a second, slow enough to watch.
"""

import numpy as np

from .model import Cloth, FloatArray, IndexArray, Part, Plane

COLUMNS = 11  # of the plane's cells along x; chosen: 2 * 7 * 11 = 154
ROWS = 7  # along y
CELL = 10.0  # [mm]; chosen, so that the plane is as large as a hand
CLOTH_CELLS = 24  # each way
CLOTH_CELL = 50.0  # [mm]
RADIUS = 270.0  # [mm] of the ball: corners hang down by as much as half of it is high
ABOVE = 10.0  # [mm] from the ball up to the sheet
COLOURS = ((0.88, 0.86, 0.80), (0.72, 0.30, 0.24))  # of the ball's sectors, which show its turning
SECTORS = 12
LATITUDES, LONGITUDES = 48, 96  # of the ball: no corners on its outline
SHINE = 0.35


def make_plane() -> Plane:
    """Build the rectangle in the plane z = 0, centred on the origin, facing +z."""
    return Plane(*make_grid(COLUMNS, ROWS, CELL))


def make_grid(columns: int, rows: int, cell: float) -> tuple[FloatArray, IndexArray]:
    """Vertices and faces of square cells around the origin of z = 0, facing +z; read-only.

    Every cell is halved along the same diagonal, lower left to upper right.
    """
    x = cell * (np.arange(columns + 1) - columns / 2)
    y = cell * (np.arange(rows + 1) - rows / 2)
    grid_x, grid_y = np.meshgrid(x, y)
    vertices = np.stack([grid_x, grid_y, np.zeros_like(grid_x)], axis=-1).reshape(-1, 3)

    row, column = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    lower_left = (row * (columns + 1) + column).ravel()
    lower_right, upper_left = lower_left + 1, lower_left + columns + 1
    upper_right = upper_left + 1
    lower = np.stack([lower_left, lower_right, upper_right], axis=-1)
    upper = np.stack([lower_left, upper_right, upper_left], axis=-1)
    faces = np.stack([lower, upper], axis=1).reshape(-1, 3).astype(np.int32)

    vertices.flags.writeable = False
    faces.flags.writeable = False
    return vertices, faces


def make_cloth() -> Cloth:
    """Build the sheet, facing +y, above a ball around the origin."""
    flat, faces = make_grid(CLOTH_CELLS, CLOTH_CELLS, CLOTH_CELL)
    vertices = flat[:, [1, 2, 0]] + [0.0, RADIUS + ABOVE, 0.0]
    vertices.flags.writeable = False
    return Cloth(vertices, faces, make_ball(), RADIUS)


def make_ball() -> Part:
    """A ball with sectors around the y axis; triangles share no vertex, so their edges are crisp.

    A grid of longitudes and latitudes, bent round.
    """
    flat, faces = make_grid(LONGITUDES, LATITUDES, 1.0)
    longitude, latitude = 2.0 * np.pi * flat[:, 0] / LONGITUDES, np.pi * flat[:, 1] / LATITUDES
    out = np.cos(latitude)
    directions = np.stack([out * np.sin(longitude), np.sin(latitude), out * np.cos(longitude)], -1)
    corners = directions[faces].reshape(-1, 3).astype(np.float32)
    sector = np.floor(flat[faces, 0].mean(axis=1) * SECTORS / LONGITUDES).astype(int)
    colours = np.repeat(np.array(COLOURS, np.float32)[sector % 2], 3, axis=0)
    numbers = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    for array in (corners, colours, numbers):
        array.flags.writeable = False
    vertices = np.float32(RADIUS) * corners
    return Part("ball", vertices, corners, numbers, colours, bone="ball", shine=SHINE)
