"""In trimesh's world: a mesh comes from trimesh, and every frame goes back as one.

    python examples/in_trimesh.py

A capsule twists. trimesh keeps vertices apart that differ in normals or texture; `refine.weld`
joins them, so that no crack opens where they touch.
"""

import numpy as np
import numpy.typing as npt
import trimesh

from risorius import refine

Points = npt.NDArray[np.float64]


def twisted(points: Points, angle: float) -> Points:
    """Twisted about the z axis, by `angle` [radians] from one end to the other."""
    height = points[:, 2] / np.ptp(points[:, 2])
    sine, cosine = np.sin(angle * height), np.cos(angle * height)
    x, y, z = points.T
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=1)


def main() -> list[trimesh.Trimesh]:
    """Twist a capsule in eight frames; the refined frames as meshes of trimesh."""
    mesh = trimesh.creation.capsule(height=4.0, radius=1.0, count=[10, 10])
    used, faces = refine.weld(mesh.vertices, mesh.faces)
    rest = np.asarray(mesh.vertices)[used] * [1.0, 0.5, 1.0]  # flat, so that a twist bends it
    refiner = refine.create("kahler", faces, rest)
    frames = []
    for angle in np.linspace(0.0, np.pi, 8):
        refined = refiner.refine(twisted(rest, angle))
        frames.append(
            trimesh.Trimesh(
                vertices=refined.positions.copy(),  # the buffers are reused by the next frame
                faces=refined.triangles.astype(np.int64),
                vertex_normals=refined.normals.copy(),
                process=False,  # as it is: nothing merged, nothing dropped
            )
        )
    return frames


if __name__ == "__main__":
    for number, frame in enumerate(main()):
        closed = "watertight" if frame.is_watertight else "open"
        print(
            f"frame {number}: {len(frame.faces):5d} triangles, {closed}, volume {frame.volume:.2f}"
        )
