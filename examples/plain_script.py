"""The plug-in in a plain script: arrays in, refined triangles out, one OBJ file to view.

    python examples/plain_script.py [FILE.obj]

A tube of 384 triangles bends to more than half a ring and back. The script needs only
`risorius.refine`, which needs only numpy and numba.
"""

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

from risorius import refine

Points = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int32]

TUBE_LENGTH = 8.0


def tube() -> tuple[Points, Triangles]:
    """A straight tube along y, open at both ends."""
    around = 12  # cells of the tube
    along = 16
    angles = 2.0 * np.pi * np.arange(around) / around
    heights = TUBE_LENGTH * np.linspace(0.0, 1.0, along + 1)
    height, angle = np.meshgrid(heights, angles, indexing="ij")
    vertices = np.stack([np.cos(angle), height, -np.sin(angle)], axis=2)  # radius 1
    ring, k = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    a = ring * around + k
    b = ring * around + (k + 1) % around
    lower = np.stack([a, b, b + around], axis=2)
    upper = np.stack([a, b + around, a + around], axis=2)
    faces = np.concatenate([lower, upper]).reshape(-1, 3)
    return vertices.reshape(-1, 3), faces.astype(np.int32)


def bent(rest: Points, angle: float) -> Points:
    """The tube bent to an arc of `angle` [radians]."""
    curvature = max(angle, 1e-9) / TUBE_LENGTH
    turn = curvature * rest[:, 1]
    across = 1.0 / curvature - rest[:, 0]  # distance from the middle of the arc
    x = 1.0 / curvature - across * np.cos(turn)
    y = across * np.sin(turn)
    return np.stack([x, y, rest[:, 2]], axis=1)


def write_obj(path: Path, mesh: refine.RefinedMesh) -> None:
    """Write triangles with their normals; every modelling program reads it."""
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in mesh.positions]
    lines += [f"vn {x:.6f} {y:.6f} {z:.6f}" for x, y, z in mesh.normals]
    lines += [f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in mesh.triangles + 1]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(target: Path) -> list[int]:
    """Refine 60 frames, write the most bent frame, return the number of triangles of each."""
    rest, faces = tube()
    refiner = refine.create("kahler", faces, rest)  # once per mesh
    counts = []
    bend = 3.5  # [radians] of the last frame
    for frame in range(60):
        angle = bend * np.sin(np.pi * frame / 59)
        mesh = refiner.refine(bent(rest, angle))  # each frame: views of reused buffers
        counts.append(len(mesh.triangles))
    write_obj(target, refiner.refine(bent(rest, bend)))
    return counts


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "tube.obj")
    triangles = main(file)
    print(f"{triangles[0]} triangles at rest, {max(triangles)} at most; bent most: {file}")
