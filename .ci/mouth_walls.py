"""Shorten the mouth's walls, and let them go with the jaw.

`python .ci/mouth_walls.py OLD NEW` reads head.npz of revision f09f0a8b and writes another. The
walls hung down to the throat, so that they reached the floor of the mouth when the jaw was open.
Now they end beside the floor, and stretch down with the mandible.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from risorius.assets.data_files import read_arrays
from risorius.assets.model import FloatArray
from risorius.assets.smooth import smooth_step
from risorius.geometry.normals import vertex_normals

WALLS = "oral_cavity_upper"
ROWS, COLUMNS = 6, 33  # the curtain: its last vertices, from its upper edge down
KEPT = -72.0  # [mm] height above which it stays
LOWEST = (-92.0, -97.0)  # [mm] height of its lower edge, at the throat and beside the teeth
TEETH = -67.0  # [mm] height of the upper gums' edge: below it the curtain stretches
BESIDE = (20.0, 60.0)  # [mm] z: from the throat to beside the teeth, where LOWEST is the second
# z [mm] and how far the lower edge goes with the mandible: wholly where the throat ends in the
# floor of the mouth, half of the way beside both jaws, as cheeks do, not at the mouth's corners.
GOES = ((25.0, 1.0), (45.0, 0.6), (60.0, 0.6), (80.0, 0.0))


def shortened(curtain: FloatArray) -> FloatArray:
    """The curtain with its lower edge no deeper than LOWEST."""
    result = curtain.copy()
    for column in range(COLUMNS):
        heights = curtain[:, column, 1]
        edge = heights[-1]
        forward = float(smooth_step(*BESIDE, curtain[-1, column, 2]))
        lowest = LOWEST[0] + forward * (LOWEST[1] - LOWEST[0])
        if edge < lowest:
            below = np.minimum(heights - KEPT, 0.0)
            result[:, column, 1] += below * ((lowest - KEPT) / (edge - KEPT) - 1.0)
        # Rows go down as straight as they hung at the height to which they reach now.
        for way in (0, 2):
            result[:, column, way] = np.interp(
                -result[:, column, 1], -heights, curtain[:, column, way]
            )
    return result


def shares_of(curtain: FloatArray) -> FloatArray:
    """How far each vertex goes with the mandible, shape (ROWS, COLUMNS)."""
    edge = curtain[-1]
    down = (TEETH - curtain[:, :, 1]) / (TEETH - edge[:, 1])
    places, shares = np.array(GOES).T
    return np.asarray(smooth_step(0.0, 1.0, down) * np.interp(edge[:, 2], places, shares))


def main(old: Path, new: Path) -> None:
    """Write the head with its walls mended."""
    arrays = {name: array.copy() for name, array in read_arrays(old).items()}
    number = arrays["part_names"].tolist().index(WALLS)
    begin, end = (int(arrays["part_vertex_counts"][:k].sum()) for k in (number, number + 1))
    first_face, last_face = (
        int(arrays["part_face_counts"][:k].sum()) for k in (number, number + 1)
    )
    first = end - ROWS * COLUMNS
    vertices = arrays["part_vertices"]
    curtain = vertices[first:end].astype(np.float64).reshape(ROWS, COLUMNS, 3)
    curtain = shortened(curtain)
    vertices[first:end] = curtain.reshape(-1, 3)
    walls = vertices[begin:end].astype(np.float64)
    normals = vertex_normals(walls, arrays["part_faces"][first_face:last_face])
    arrays["part_normals"][first:end] = normals[first - begin :]
    arrays["part_mandible_shares"] = np.zeros(len(vertices), np.float32)
    arrays["part_mandible_shares"][first:end] = shares_of(curtain).ravel()
    np.savez_compressed(new, allow_pickle=False, **arrays)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
