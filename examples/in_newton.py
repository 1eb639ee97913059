"""A fine mesh on a coarse cloth of Newton: `refine.Embedding` beside Newton's own binding.

    pip install '.[newton]'
    python examples/in_newton.py

A square sheet is held at its border and sags. Newton simulates 128 triangles, on the processor.
They move a finer mesh in two ways: as Newton's visual mesh, which is flat on each triangle, and
through `refine.Embedding`. A simulation with four times the triangles gives the true positions of
the finer mesh.
"""

import newton
import numpy as np
import warp as wp

from risorius import refine

CELL_COUNT = 8
CLOTH_SIDE = 2.0  # [m]


def cloth(cells: int) -> newton.ModelBuilder:
    """A sheet of cells x cells squares, whose border is held."""
    builder = newton.ModelBuilder()
    builder.add_cloth_grid(
        pos=wp.vec3(0.0, 0.0, 0.0),
        rot=wp.quat_identity(),
        vel=wp.vec3(0.0, 0.0, 0.0),
        dim_x=cells,
        dim_y=cells,
        cell_x=CLOTH_SIDE / cells,
        cell_y=CLOTH_SIDE / cells,
        mass=1.0 / (cells + 1) ** 2,
        fix_left=True,
        fix_right=True,
        fix_top=True,
        fix_bottom=True,
        tri_ke=50.0,
        tri_ka=50.0,
        tri_kd=2.0,
        edge_ke=0.0,
        edge_kd=0.0,
    )
    builder.color()
    return builder


def sagged(model: newton.Model) -> newton.State:
    """The sheet after four seconds."""
    solver = newton.solvers.SolverVBD(model, iterations=20)
    state = model.state()
    following = model.state()
    control = model.control()
    for _ in range(480):
        state.clear_forces()
        solver.step(state, following, control, None, 1.0 / 120.0)
        state, following = following, state
    return state


def main() -> dict[str, float]:
    """Compute root mean square distances from the finer simulation [mm]."""
    finer = cloth(2 * CELL_COUNT).finalize(device="cpu")
    fine = finer.particle_q.numpy().astype(np.float64)
    triangles = finer.tri_indices.numpy()
    truth = sagged(finer).particle_q.numpy().astype(np.float64)

    builder = cloth(CELL_COUNT)
    count = len(builder.tri_indices)
    builder.add_deformable_visual_mesh(
        fine, triangles.ravel(), kind="triangle", tri_range=(0, count)
    )
    coarse = builder.finalize(device="cpu")
    rest = coarse.particle_q.numpy().astype(np.float64)
    faces = coarse.tri_indices.numpy().reshape(-1, 3)
    embedding = refine.Embedding(faces, rest, fine)  # once
    state = sagged(coarse)
    shown = newton.geometry.DeformableVisuals(coarse).update(state).points.numpy()
    positions = state.particle_q.numpy()
    carried = embedding.evaluate(positions).positions  # every frame

    is_same_place = (np.abs(fine[:, None] - rest) < 1e-6).all(axis=2)
    is_coarse = is_same_place.any(axis=1)
    errors = {
        "Newton's visual mesh, flat": shown - truth,
        "refine.Embedding": carried - truth,
        "the coarse vertices themselves": (shown - truth)[is_coarse],
    }
    return {
        name: 1000.0 * float(np.sqrt((error**2).sum(axis=1).mean()))
        for name, error in errors.items()
    }


if __name__ == "__main__":
    distances = main()
    finer_count = 8 * CELL_COUNT**2
    print(f"Newton {newton.__version__}: root mean square distance from {finer_count} triangles")
    for name, distance in distances.items():
        print(f"  {name}: {distance:.1f} mm")
