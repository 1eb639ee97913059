r"""Cloth that falls over a ball: the springs of the skin, free of any bone.

The membrane is that of the skin (tissue.py), with two differences. Nothing holds a vertex but the
hands that hold the whole sheet up: a tissue spring to its place at rest. And cloth resists being
bent, by springs between the corners that face each other across an edge:

          2
         / \         0-1, 1-2, 2-0, ...   resist stretch, as every edge
        0---1        2-3                  resists a bend at the edge 0-1
         \ /
          3

Vertices are kept out of the ball as out of an eyeball, and are rubbed by it (Coulomb), so that the
sheet does not slide off, and follows where the ball turns. Cloth does not feel itself: deep folds
may cross. Millimetres, seconds, y up.

Source: Kähler et al. 2003, Figure 1 (any triangle mesh as a spring mesh); Provot 1995,
"Deformation constraints in a mass-spring model" (springs over two edges against bending).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..jit import njit
from . import checked
from .anatomy import mesh_of
from .landmarks import Array
from .state import State
from .substep import accelerate, damp, edge_forces, move, parts, tissue_forces
from .surface import Surface, build_surface
from .tissue import AREAL_MASS, EdgeSprings, TissueSprings, masses_for_step, tissue_energy

GRAVITY = np.array([0.0, -9810.0, 0.0])  # mm/s2
LONGEST_SUBSTEP = 1.0 / 1200.0  # s: shorter than skin's, because cloth hardly stretches
STRETCH = 1.6e8 * AREAL_MASS  # mm2: what hangs from one metre of itself is 6 % longer at the top
BEND = 0.15  # x STRETCH; chosen by eye: folds are some triangles wide
DAMPING = 3.0  # 1/s, by the air around; chosen by eye: at rest after some 3 s
FRICTION = 0.5  # of Coulomb: wool on a painted ball
CLEARANCE = 0.03  # of the ball's radius: triangles and smoothing cut corners, by less than that
HOLD_RATE = 9.0  # rad/s of the hands' springs: from draped to flat in half a second


class Ball(NamedTuple):
    """What the cloth falls over."""

    centre: Array  # (3,) mm
    reach: float  # mm from the centre, within which no vertex comes
    turning: float  # rad/s about the vertical


class Fabric(NamedTuple):
    """What does not change while a cloth moves, under the names that the kernels of skin know."""

    mass: Array  # (V,)
    tissue: TissueSprings  # of no stiffness: only hands hold, see State.hold
    edges: EdgeSprings


class Cloth:
    """A sheet over a ball, held up flat until it is let go.

    held: how firmly, from 1 (flat, at rest) to 0 (falls freely). turning: speed of the ball about
    the vertical [rad/s]. Both may be set at any time.
    """

    def __init__(self, mesh: Any, centre: npt.ArrayLike, radius: float) -> None:
        """`mesh`: any object with `vertices` (V, 3) [mm] and `faces` (F, 3), the sheet at rest.

        centre, radius: of the ball [mm]. Raises ValueError naming what is wrong.
        """
        surface = build_surface(*mesh_of("mesh", mesh))
        edges = fabric_springs(surface)
        count = surface.vertex_count
        self._fabric = Fabric(
            mass=masses_for_step(surface.areas, edges.row_bound(count), LONGEST_SUBSTEP),
            tissue=TissueSprings(np.zeros(count), np.zeros(count), DAMPING, damping_ratio=1.0),
            edges=edges,
        )
        reach = (1.0 + CLEARANCE) * checked.number("radius", radius)
        self._ball = Ball(checked.numbers("centre", centre, (3,)), reach, 0.0)
        state = State.at_rest(surface)
        self._state = state._replace(tension=np.zeros(len(edges.edges)))
        self.faces, self.rest_positions = surface.faces, surface.positions
        self.held, self.turning, self.turned = 1.0, 0.0, 0.0

    @property
    def positions(self) -> Array:
        """Vertices now [mm], shape (V, 3); read only for everybody else."""
        return self._state.x

    def reset(self) -> None:
        """Flat and held again, over a ball that stands still as it stood at first."""
        self._state.x[:] = self.rest_positions
        self._state.v[:] = 0.0
        self.held, self.turning, self.turned = 1.0, 0.0, 0.0

    def step(self, dt: float) -> None:
        """Advance by `dt` [s]; `turned` is how far the ball has come [rad].

        Hands bear as much of the weight as they hold, so what is held whole does not sag.
        """
        state, mass = self._state, self._fabric.mass
        state.hold[:] = self.held * mass * HOLD_RATE**2
        state.pull[:] = (1.0 - self.held) * mass[:, None] * GRAVITY
        count = parts(dt, LONGEST_SUBSTEP)
        ball = self._ball._replace(turning=self.turning)
        advance_cloth(state, self._fabric, ball, count, dt / count)
        self.turned += self.turning * dt

    def energy(self) -> float:
        """Energy of motion, springs and height, in mass units times (mm/s)^2."""
        state, mass = self._state, self._fabric.mass
        kinetic = float((mass[:, None] * state.v**2).sum() / 2.0)
        height = -float((state.pull * (state.x - self.rest_positions)).sum())
        held = tissue_energy(state, self._fabric.tissue)
        return kinetic + height + held + self._fabric.edges.energy(state.x, state.x)


def fabric_springs(surface: Surface) -> EdgeSprings:
    """Springs along all edges, and across them from corner to corner."""
    across = corners_across(surface.faces)
    pairs = np.vstack([surface.edges, across])
    stiffness = np.append(surface.edge_stiffness, np.full(len(across), BEND))
    order = np.lexsort(pairs.T[::-1])
    pairs, x = pairs[order], surface.positions
    return EdgeSprings(
        edges=pairs.astype(np.uint32),
        rows=np.searchsorted(pairs[:, 0], np.arange(len(x) + 1)).astype(np.uint32),
        rest_length=np.linalg.norm(x[pairs[:, 1]] - x[pairs[:, 0]], axis=1),
        stiffness=STRETCH * stiffness[order],
        shear=np.zeros(len(pairs)),
        stiffening=1.0,
        strain_limit=0.0,
    )


def corners_across(faces: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """The corners that face each other across edges of two triangles, shape (n, 2), lower first."""
    sides = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    corners = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    order = np.lexsort(sides.T[::-1])
    sides, corners = sides[order], corners[order]
    is_shared = (sides[1:] == sides[:-1]).all(axis=1)
    pairs = np.stack([corners[:-1][is_shared], corners[1:][is_shared]], axis=1)
    return np.unique(np.sort(pairs, axis=1), axis=0)


@njit
def advance_cloth(state, fabric, ball, substeps, h):  # type: ignore[no-untyped-def]
    """Advance a cloth by some substeps of `h` [s]."""
    damp(state, fabric, h)
    for _ in range(substeps):
        tissue_forces(state, fabric.tissue)
        edge_forces(state, fabric.edges)
        accelerate(state)
        meet_ball(state, ball, h)
        move(state, h)


@njit
def meet_ball(state, ball, h):  # type: ignore[no-untyped-def]
    """Stop whoever would come too near the ball within `h`, and rub it by as much.

    What stays along a tangent only gets farther away, so no position has to be mended.
    """
    x, v, centre = state.x, state.v, ball.centre
    for i in range(len(x)):
        dx, dy, dz = x[i, 0] - centre[0], x[i, 1] - centre[1], x[i, 2] - centre[2]
        distance = max(np.sqrt(dx * dx + dy * dy + dz * dz), 1e-9)
        nx, ny, nz = dx / distance, dy / distance, dz / distance
        speed = v[i, 0] * nx + v[i, 1] * ny + v[i, 2] * nz
        stopped = (ball.reach - distance) / h - speed
        if stopped <= 0.0:
            continue
        # Its way along the ball, as seen from the ball's surface.
        sx = v[i, 0] - speed * nx - ball.turning * dz
        sy = v[i, 1] - speed * ny
        sz = v[i, 2] - speed * nz + ball.turning * dx
        sliding = np.sqrt(sx * sx + sy * sy + sz * sz)
        rubbed = min(FRICTION * stopped / max(sliding, 1e-9), 1.0)
        v[i, 0] += stopped * nx - rubbed * sx
        v[i, 1] += stopped * ny - rubbed * sy
        v[i, 2] += stopped * nz - rubbed * sz
