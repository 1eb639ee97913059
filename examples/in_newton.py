"""In Newton: a coarse cloth is simulated, and a refined one is seen, in any of its viewers.

    python examples/in_newton.py                                            # a window
    python examples/in_newton.py --viewer usd --output-path cloth.usd       # a file
    python examples/in_newton.py --viewer null --test                       # neither

A sheet of 288 triangles hangs by two corners. On the CPU the refiner reads the simulation's own
memory (`particle_q.numpy()` copies nothing), and the simulation never learns of it. Needs
`pip install newton`.
"""

from typing import Any

import newton
import newton.examples
import numpy as np
import warp as wp

from risorius import refine

FRAME, SUBSTEPS = 1 / 60, 10  # [s]
PLACE = {"pos": wp.vec3(0.0, 0.0, 3.0), "rot": wp.quat_identity(), "vel": wp.vec3()}
GRID = {"dim_x": 12, "dim_y": 12, "cell_x": 0.15, "cell_y": 0.15, "particle_radius": 0.05}
STUFF = {"mass": 0.1, "edge_ke": 1.0e1, "spring_ke": 1.0e3, "spring_kd": 1.0}


class Example:
    """A cloth as Newton's own examples have it, drawn finer than it is simulated."""

    def __init__(self, viewer: Any, args: Any) -> None:
        """Bind the refiner to the cloth at rest, before anything moves."""
        self.viewer = viewer
        self.time = 0.0
        builder = newton.ModelBuilder()
        builder.add_cloth_grid(**PLACE, **GRID, **STUFF, add_springs=True)
        for corner in (0, 12):
            builder.particle_mass[corner] = 0.0  # held
        self.model = builder.finalize()
        self.solver = newton.solvers.SolverXPBD(self.model, iterations=10)
        self.state, self.next_state = self.model.state(), self.model.state()
        self.control = self.model.control()
        faces = self.model.tri_indices.numpy().reshape(-1, 3)
        rest = self.state.particle_q.numpy()
        self.refiner = refine.create(
            "kahler", faces, rest, scheme="cubic", criterion="displacement+border"
        )
        self.triangle_counts: list[int] = []
        viewer.set_model(self.model)
        viewer.show_triangles = False  # the coarse cloth

    def step(self) -> None:
        """Simulate one frame."""
        for _ in range(SUBSTEPS):
            self.state.clear_forces()
            self.viewer.apply_forces(self.state)
            self.solver.step(self.state, self.next_state, self.control, None, FRAME / SUBSTEPS)
            self.state, self.next_state = self.next_state, self.state
        self.time += FRAME

    def render(self) -> None:
        """Refine the frame, and hand it to the viewer."""
        self.mesh = self.refiner.refine(self.state.particle_q.numpy())
        self.triangle_counts.append(self.mesh.triangle_count)
        self.viewer.begin_frame(self.time)
        self.viewer.log_mesh(
            "/cloth",
            wp.array(self.mesh.positions, dtype=wp.vec3),
            wp.array(self.mesh.triangles.ravel(), dtype=wp.uint32),
            normals=wp.array(self.mesh.normals, dtype=wp.vec3),
            backface_culling=False,
            dynamic=True,  # other triangles in every frame
        )
        self.viewer.end_frame()

    def test_final(self) -> None:
        """Newton's runner calls it with --test."""
        refine.check(self.refiner, self.mesh, self.state.particle_q.numpy())
        assert max(self.triangle_counts) > 2 * self.triangle_counts[0]
        assert np.isfinite(self.mesh.positions).all()


if __name__ == "__main__":
    viewer, args = newton.examples.init()
    newton.examples.run(Example(viewer, args), args)
