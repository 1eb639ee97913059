"""The paper's second test case: a flat sheet.

It has 7 x 11 cells. Source: Kähler et al. 2003, Figure 9 and Table 1 ("plane", 154 triangles). 154
= 2 * 7 * 11: no other grid of halved cells with this count is about as wide as in the figure.
"""

import numpy as np

from ..geometry.arrays import Floats64, Integers32
from .topology import grid_faces

SHEET_COLUMNS = 11  # cells along x; chosen: 2 * 7 * 11 = 154
SHEET_ROWS = 7  # along y
CELL_SIZE = 10.0  # [mm]; chosen, so that the plane is as large as a hand


def make_grid(columns: int, rows: int, cell: float) -> tuple[Floats64, Integers32]:
    """Vertices and faces of square cells around the origin of z = 0, facing +z; read-only.

    Every cell is halved along the same diagonal, lower left to upper right.
    """
    x = cell * (np.arange(columns + 1) - columns / 2)
    y = cell * (np.arange(rows + 1) - rows / 2)
    vertices = np.stack(np.meshgrid(x, y, [0.0]), axis=-1).reshape(-1, 3)

    numbers = np.arange(len(vertices)).reshape(rows + 1, columns + 1)
    by_column = grid_faces(numbers.T).reshape(columns, rows, -1)
    by_row = by_column.swapaxes(0, 1)
    faces = by_row.reshape(-1, 3)

    vertices.flags.writeable = False
    faces.flags.writeable = False
    return vertices, faces
