"""Mend the walls of the mouth: `python -m risorius.bench.walls_mending FILE`, a head.npz to write.

Walls go with the skull, so a cheek that is drawn in by an open mouth let them through. They are
pushed behind the skin of poses in which that is so, and bend as evenly as they can.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from risorius import assets, sim
from risorius.assets.data_files import read_arrays
from risorius.assets.fitting.warp import nearest_on
from risorius.assets.loading import HEAD_FILE
from risorius.assets.model import FloatArray, Head, IndexArray
from risorius.geometry.normals import vertex_normals

from .subjects import settled_positions

WALL, DEPTH = "oral_cavity_upper", 1.5  # [mm] behind the skin
OPENED: tuple[dict[str, float], ...] = (
    {}, {"jaw_open": 0.5}, {"jaw_open": 1.0}, {"joy": 1.0, "jaw_open": 0.7}, {"yawn": 1.0},
    {"joy": 1.0, "jaw_open": 1.0}, {"surprise": 1.0}, {"AU27": 1.0, "AU20": 1.0}, {"AU22": 1.0},
    {"AU27": 1.0, "AU18": 1.0}, {"AU27": 1.0, "AU12": 1.0}, {"AU27": 1.0, "AU14": 1.0},
    {"jaw_open": 0.5, "AU14": 1.0}, {"jaw_sideways": 1.0}, {"jaw_open": 0.7, "jaw_sideways": 1.0},
    {"jaw_open": 1.0, "AU10": 1.0}, {"jaw_open": 0.7, "kiss": 1.0}, {"kiss": 1.0},
)  # fmt: skip
ROUNDS, SOFTENED = 12, 4  # of pushing; how often each push is evened out
INNER = tuple(f"mouth_{row}_{side}" for row in range(4) for side in ("left", "right"))
MIRROR = np.array([-1.0, 1.0, 1.0])


def outside(
    walls: FloatArray, skin: FloatArray, normals: FloatArray, faces: IndexArray
) -> FloatArray:
    """How the points of walls (n, 3) must move to lie behind a skin [mm], shape (n, 3)."""
    at = nearest_on(walls, np.zeros_like(walls), skin, faces)
    facing = at.interpolate(normals)
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
    height = ((walls - at.interpolate(skin)) * facing).sum(axis=1)
    return np.asarray(-np.maximum(height + DEPTH, 0.0)[:, None] * facing)


def mended(head: Head, walls: FloatArray, faces: IndexArray) -> FloatArray:
    """The vertices of the walls, behind the skin in all poses."""
    simulation = sim.create(head)
    inner = np.unique(np.concatenate([head.rings[name] for name in INNER]))
    outer = head.faces[~np.isin(head.faces, inner).any(axis=1)]
    skins = []
    for pose in OPENED:
        known = {name: value for name, value in pose.items() if name in simulation.limits}
        skin = settled_positions(simulation, known, 45)
        skins.append((skin, vertex_normals(skin, head.faces)))
    image = np.linalg.norm(walls[:, None] - walls[None] * MIRROR, axis=2).argmin(axis=1)
    sides = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    x = walls.copy()
    for _ in range(ROUNDS):
        push = np.zeros_like(x)
        for skin, normals in skins:
            one = outside(x, skin, normals, outer)
            push = np.where((one**2).sum(axis=1) > (push**2).sum(axis=1), one.T, push.T).T
        wanted = push
        for _ in range(SOFTENED):
            total, count = np.zeros_like(x), np.zeros(len(x))
            for a, b in ((0, 1), (1, 0)):
                np.add.at(total, sides[:, a], push[sides[:, b]])
                np.add.at(count, sides[:, a], 1.0)
            mean = total / np.maximum(count, 1.0)[:, None]
            push = np.where(np.linalg.norm(wanted, axis=1, keepdims=True) > 1e-9, push, mean)
            push = 0.5 * push + 0.5 * mean
        longer = np.linalg.norm(wanted, axis=1) > np.linalg.norm(push, axis=1)
        push[longer] = wanted[longer]
        x += push
        x = 0.5 * (x + x[image] * MIRROR)
    left = [np.linalg.norm(outside(x, *skin, outer), axis=1).max() for skin in skins]
    print("still", np.round(left, 2), "moved", np.linalg.norm(x - walls, axis=1).max())
    return x


def main(file: Path) -> None:
    """Write the head with its walls mended."""
    head = assets.load("head")
    arrays = {name: array.copy() for name, array in read_arrays(HEAD_FILE).items()}
    begin = 0
    for part in head.parts:
        end = begin + len(part.vertices)
        if part.name == WALL:
            walls = mended(head, part.vertices.astype(np.float64), part.faces)
            normals = vertex_normals(walls, part.faces)
            arrays["part_vertices"][begin:end] = walls
            arrays["part_normals"][begin:end] = normals
        begin = end
    np.savez_compressed(file, allow_pickle=False, **arrays)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
