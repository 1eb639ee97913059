"""In a PyVista plotter: the mesh that is shown takes over the refined one of every frame.

    python examples/in_pyvista.py [PICTURE.png]

A plate under a wave, coloured by its height. Needs `pip install "risorius[pyvista]"`; PyVista finds
`mesh.risorius` by itself.
"""

import sys
from pathlib import Path

import numpy as np
import pyvista as pv


def wave(rest: pv.PolyData, phase: float) -> pv.PolyData:
    """The plate with a wave across it, which says how high each point is."""
    mesh = rest.copy()
    mesh.points[:, 2] = 0.12 * np.sin(9.0 * (rest.points[:, 0] + rest.points[:, 1]) + phase)
    mesh["height"] = mesh.points[:, 2]
    return mesh


def main(target: Path) -> list[int]:
    """Draw 12 frames offscreen, keep a picture of the last, return the triangles of each."""
    plate = pv.Plane(i_size=1.4, i_resolution=11, j_resolution=7)
    refiner = plate.risorius.refiner(criterion="displacement+border")
    shown = refiner.refine(wave(plate, 0.0))
    plotter = pv.Plotter(off_screen=True, window_size=[800, 600])
    plotter.add_mesh(shown, scalars="height", smooth_shading=True, show_edges=True)
    plotter.camera_position = [(1.0, -2.4, 1.7), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    counts = []
    for phase in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
        shown.copy_from(refiner.refine(wave(plate, phase)))  # the plotter keeps the mesh it has
        plotter.render()
        counts.append(shown.n_cells)
    plotter.screenshot(target)
    plotter.close()
    return counts


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "plate.png")
    print(f"{max(main(file))} triangles at most; the last frame: {file}")
