"""The paper's second test case: a flat sheet.

It has 7 x 11 cells. Source: Kähler et al. 2003, Figure 9 and Table 1 ("plane", 154
triangles). 154 = 2 * 7 * 11 is the only way to write the count as a grid of halved cells that is
about as wide as the figure shows.
"""

import numpy as np

from .model import FloatArray, IndexArray

COLUMNS = 11  # of cells along x; chosen: 2 * 7 * 11 = 154
ROWS = 7  # along y
CELL = 10.0  # [mm]; chosen, so that the plane is as large as a hand


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
