"""In a PyVista plotter: the mesh that is shown takes over the refined one of every frame.

    python examples/in_pyvista.py [PICTURE.png]

The built-in plane under a wave, drawn by VTK. Needs `pip install "risorius[peers]"`.
"""

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyvista

from risorius import assets, refine

Points = npt.NDArray[np.float64]


def waved(rest: Points, phase: float) -> Points:
    """The plane with a sine wave along it."""
    moved = rest.copy()
    moved[:, 2] += 18.0 * np.sin((rest[:, 0] + rest[:, 1]) / 20.0 + phase)
    return moved


def as_polydata(mesh: refine.RefinedMesh) -> pyvista.PolyData:
    """A refined mesh as VTK wants it; copied, because the next frame reuses the buffers."""
    sizes = np.full((len(mesh.triangles), 1), 3, dtype=np.int64)
    polydata = pyvista.PolyData(
        mesh.positions.copy(), np.hstack([sizes, mesh.triangles.astype(np.int64)])
    )
    polydata.point_data["Normals"] = mesh.normals.copy()
    polydata.point_data.active_normals_name = "Normals"
    return polydata


def main(target: Path) -> list[int]:
    """Draw 12 frames offscreen, keep a picture of the last, return the triangles of each."""
    plane = assets.load("plane")
    refiner = refine.create(
        "kahler", plane.faces, plane.vertices, threshold_once=0.001, threshold_twice=0.005
    )
    plotter = pyvista.Plotter(off_screen=True, window_size=[800, 600])
    polydata = as_polydata(refiner.refine(waved(plane.vertices, 0.0)))
    plotter.add_mesh(polydata, color="tan", smooth_shading=True, show_edges=True)
    plotter.camera_position = [(70.0, -170.0, 120.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    counts = []
    for frame in range(12):
        mesh = refiner.refine(waved(plane.vertices, 2.0 * np.pi * frame / 12))
        polydata.copy_from(as_polydata(mesh))  # the plotter keeps the object it was given
        plotter.render()
        counts.append(len(mesh.triangles))
    plotter.screenshot(str(target))
    plotter.close()
    return counts


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "plane.png")
    print(f"{max(main(file))} triangles at most; the last frame: {file}")
