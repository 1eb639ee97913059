"""In trimesh's world: a mesh comes from trimesh, and every frame goes back as one.

    python examples/in_trimesh.py

A capsule twists. A textured mesh of a file would do as well: what it carries goes along.
"""

import numpy as np
import trimesh

from risorius import refine


def twisted(mesh: trimesh.Trimesh, angle: float) -> np.ndarray:
    """The vertices, twisted about the z axis by `angle` [radians] from one end to the other."""
    turns = angle * mesh.vertices[:, 2] / mesh.extents[2]
    x, y, z = mesh.vertices.T
    sine, cosine = np.sin(turns), np.cos(turns)
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=1)


def main() -> list[trimesh.Trimesh]:
    """Twist a capsule in eight frames; the refined frames as meshes of trimesh."""
    mesh = trimesh.creation.capsule(height=4.0, radius=1.0, count=[10, 10])
    mesh.apply_scale([1.0, 0.5, 1.0])  # flat, so that a twist bends it
    refiner = refine.TrimeshRefiner(mesh, scheme="loop", criterion="normal")  # the paper's rule
    return [refiner.as_trimesh(twisted(mesh, angle)) for angle in np.linspace(0.0, np.pi, 8)]


if __name__ == "__main__":
    for number, frame in enumerate(main()):
        closed = "watertight" if frame.is_watertight else "open"
        print(
            f"frame {number}: {len(frame.faces):5d} triangles, {closed}, volume {frame.volume:.2f}"
        )
