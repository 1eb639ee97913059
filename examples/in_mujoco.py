"""A fine mesh on a coarse cloth of MuJoCo: `refine.Embedding` beside MuJoCo's own skin.

    pip install '.[mujoco]'
    python examples/in_mujoco.py

A square sheet is held at its border and sags. MuJoCo simulates 128 triangles. Their vertices move a
finer mesh in two ways: as the bones of a MuJoCo skin, which is flat on each triangle, and through
`refine.Embedding`. A simulation with four times the triangles gives the true positions of the finer
mesh.
"""

import mujoco
import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.geometry.closest import closest_points

Points = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int32]

CELL_COUNT = 8
CLOTH_SIDE = 2.0  # [m]


def cloth(cells: int) -> mujoco.MjSpec:
    """A sheet of cells x cells squares, whose border is pinned."""
    spacing = CLOTH_SIDE / cells
    return mujoco.MjSpec.from_string(
        f"""
        <mujoco>
          <option timestep="0.005" integrator="discrete"/>
          <worldbody>
            <flexcomp name="sheet" type="grid" dim="2" count="{cells + 1} {cells + 1} 1"
                      spacing="{spacing} {spacing} 1" mass="1" radius="0.001">
              <contact selfcollide="none" contype="0" conaffinity="0"/>
              <elasticity young="1e4" poisson="0.3" thickness="0.01" damping="0.1"
                          elastic2d="both"/>
              <pin gridrange="0 0 0 {cells}"/>
              <pin gridrange="{cells} 0 {cells} {cells}"/>
              <pin gridrange="0 0 {cells} 0"/>
              <pin gridrange="0 {cells} {cells} {cells}"/>
            </flexcomp>
          </worldbody>
        </mujoco>
        """
    )


def add_skin(spec: mujoco.MjSpec, fine: Points, triangles: Triangles) -> None:
    """Bind `fine` to the bodies of the coarse vertices, by weights on flat triangles."""
    model = spec.compile()
    rest, faces = sheet_of(model)
    places = closest_points(fine, rest, faces)
    bodies = model.flex_vertbodyid[places.corners]  # pinned vertices belong to the world, 0
    names = []
    starts = []
    bound = []
    weights = []
    for body in np.unique(bodies):
        of_body = np.where(bodies == body, places.weights, 0.0).sum(axis=1)
        numbers = np.flatnonzero(of_body > 0.0)
        names.append(model.body(body).name)
        starts += model.body_pos[body].tolist()
        bound.append(numbers.tolist())
        weights.append(of_body[numbers].tolist())
    spec.add_skin(
        name="fine",
        vert=fine.ravel().tolist(),
        face=triangles.ravel().tolist(),
        bodyname=names,
        bindpos=starts,
        bindquat=[1.0, 0.0, 0.0, 0.0] * len(names),
        vertid=bound,
        vertweight=weights,
    )


def sheet_of(model: mujoco.MjModel) -> tuple[Points, Triangles]:
    """Vertices and triangles of the sheet at rest."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data.flexvert_xpos.copy(), model.flex_elem.reshape(-1, 3).astype(np.int32)


def sagged(spec: mujoco.MjSpec) -> tuple[Points, Points]:
    """Vertices of the sheet and of its skin, if any, after two seconds."""
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(400):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    scene = mujoco.MjvScene(model, maxgeom=10)
    everything = int(mujoco.mjtCatBit.mjCAT_ALL)
    camera = mujoco.MjvCamera()
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, camera, everything, scene)
    return data.flexvert_xpos.copy(), scene.skinvert.reshape(-1, 3).astype(np.float64)


def main() -> dict[str, float]:
    """Compute root mean square distances from the finer simulation [mm]."""
    finer = cloth(2 * CELL_COUNT)
    fine, triangles = sheet_of(finer.compile())
    truth, _ = sagged(finer)

    coarse = cloth(CELL_COUNT)
    rest, faces = sheet_of(coarse.compile())
    embedding = refine.Embedding(faces, rest, fine)  # once
    add_skin(coarse, fine, triangles)
    positions, skin = sagged(coarse)
    carried = embedding.evaluate(positions).positions  # every frame

    is_coarse = (fine[:, None] == rest).all(axis=2).any(axis=1)
    errors = {
        "MuJoCo's skin, flat": skin - truth,
        "refine.Embedding": carried - truth,
        "the coarse vertices themselves": (skin - truth)[is_coarse],
    }
    return {
        name: 1000.0 * float(np.sqrt((error**2).sum(axis=1).mean()))
        for name, error in errors.items()
    }


if __name__ == "__main__":
    print(
        f"MuJoCo {mujoco.__version__}: root mean square distance from {4 * 2 * CELL_COUNT**2} "
        "triangles"
    )
    for name, distance in main().items():
        print(f"  {name}: {distance:.1f} mm")
