"""Where the skin comes to rest, by one linear solve: what a fit of many numbers can afford.

The face of sim/ without what is not linear in its motion: contacts, biphasic stiffening, and
muscles that carry each other. At rest the forces on the skin are in balance,

    (K + hold) u = pull

with K of tissue and edges, and with hold and pull of all muscles at their activations
(sim/muscle_forces.py). The derivative after any number of a muscle is one more solve,

    (K + hold) du = d pull - d hold u

On eleven scanned shapes u has cosines of 0.94 to 1.00 to what `sim` simulates (median 0.997).

Source: implicit differentiation of an equilibrium.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from risorius.sim.anatomy import Anatomy
from risorius.sim.contact import Grip
from risorius.sim.fibres import SAMPLES, build_fibre, contract
from risorius.sim.landmarks import Side
from risorius.sim.muscles import AttachedPoints, Attachment, attach_to_fibre, attach_to_ring
from risorius.sim.rig import Fibre, LinearMuscle, Muscle, RingMuscle
from risorius.sim.substep import SEAL_AXES

Array = npt.NDArray[np.float64]

CACHED = 4096  # muscles and pulls that are remembered; a fit asks for each many times


class Pull(NamedTuple):
    """What muscles do to the skin."""

    force: Array  # (V, 3)
    hold: Array  # (V,) stiffness that they add

    def plus(self, other: Pull) -> Pull:
        """Both at once."""
        return Pull(self.force + other.force, self.hold + other.hold)

    def minus(self, other: Pull) -> Pull:
        """What is more than the other."""
        return Pull(self.force - other.force, self.hold - other.hold)


class Balance(NamedTuple):
    """A pose in balance."""

    moved: Array  # (V, 3) mm
    factors: Any  # of the stiffness matrix

    def derivatives(self, changes: list[Pull]) -> Array:
        """How the skin moves for small changes of the pull, shape (V, 3, n)."""
        loads = [each.force - each.hold[:, None] * self.moved for each in changes]
        found: Array = self.factors.solve(np.stack([load.ravel() for load in loads], axis=1))
        return found.reshape(-1, 3, len(changes))


class Statics:
    """A face whose muscles can be exchanged, and poses of it in balance."""

    def __init__(self, anatomy: Anatomy) -> None:
        self._anatomy = anatomy
        surface, tissue = anatomy.surface, anatomy.rig.tissue
        self._places = AttachedPoints(surface.positions, surface.normals, anatomy.lip_side)
        self._strength = tissue.stiffness_scale * surface.areas
        self._stiffness = _stiffness_of(anatomy)
        self._seal = _seal_of(anatomy)
        self._lids = np.zeros(surface.vertex_count)
        if anatomy.lids is not None:
            np.add.at(self._lids, anatomy.lids.vertices.vertex, anatomy.lids.hold)
        self._attached = lru_cache(CACHED)(self._attach)
        self._pulled = lru_cache(CACHED)(self._pull)

    def balance(self, muscles: Mapping[str, Muscle], values: Mapping[str, float]) -> Balance:
        """Let the skin come to rest under controls of muscles, all others relaxed."""
        count = self._anatomy.surface.vertex_count
        total, seal = Pull(np.zeros((count, 3)), self._lids.copy()), 1.0
        for muscle in muscles.values():
            for side in _sides(muscle):
                hold, tone = self._attached(muscle, side)[0], self._anatomy.rig.tissue.passive
                total = total.plus(Pull(np.zeros((count, 3)), muscle.tone * tone * hold))
        for control, value in values.items():
            total = total.plus(self.pull(muscles[whole(control)], control, value))
            sides = _controlled(muscles[whole(control)], control)
            seal *= (1.0 - value * muscles[whole(control)].opens_lips) ** len(sides)
        matrix = self._stiffness + sparse.diags(np.repeat(total.hold, 3))
        matrix = matrix + Grip.of(max(seal, 0.0), 0.0).stiffness * self._seal
        factors = splu(
            matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )  # fmt: skip
        return Balance(factors.solve(total.force.ravel()).reshape(-1, 3), factors)

    def pull(self, muscle: Muscle, control: str, value: float) -> Pull:
        """What a muscle does at a value of its control, on the sides that it is for."""
        activation = value ** (self._anatomy.rig.tissue.drive_power * muscle.drive)
        count = self._anatomy.surface.vertex_count
        total = Pull(np.zeros((count, 3)), np.zeros(count))
        for side in _controlled(muscle, control):
            total = total.plus(self._pulled(muscle, side, activation))
        return total

    def _attach(self, muscle: Muscle, side: Side) -> tuple[Array, Array, list[_Strand]]:
        """Stiffness of the hold at full activation, steady displacement, and strands that pull."""
        surface, landmarks = self._anatomy.surface, self._anatomy.landmarks
        holds, strands = list[Attachment](), list[_Strand]()
        if isinstance(muscle, LinearMuscle):
            for fibre in muscle.fibres:
                points = build_fibre(fibre, muscle, surface, landmarks, side)
                holds.append(attach_to_fibre(muscle, fibre, points, side, self._places))
                strands.append(_Strand(points, fibre, holds[-1]))
        else:
            assert isinstance(muscle, RingMuscle)
            line = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])  # the pull needs no place on it
            holds.append(attach_to_ring(muscle, line, landmarks, side, self._places))
        weight = np.max([each.weight for each in holds], axis=0)
        steady: Array = np.sum([each.steady for each in holds], axis=0)
        return muscle.stiffness * self._strength * weight, steady, strands

    def _pull(self, muscle: Muscle, side: Side, activation: float) -> Pull:
        """What a muscle does on one side."""
        hold, steady, strands = self._attached(muscle, side)
        passive = self._anatomy.rig.tissue.passive * muscle.tone
        force = activation * steady
        for strand in strands:
            force = force + strand.drawn(muscle, activation)
        force *= (passive + (1.0 - passive) * activation) * muscle.stiffness
        return Pull(force * self._strength[:, None], (1.0 - passive) * activation * hold)


class _Strand(NamedTuple):
    """A fibre in the face, and how the skin hangs on it."""

    points: Array
    fibre: Fibre
    skin: Attachment

    def drawn(self, muscle: Muscle, activation: float) -> Array:
        """Where it draws the skin [mm x weight], shape (V, 3)."""
        assert isinstance(muscle, LinearMuscle)
        along = np.zeros((SAMPLES, 3))
        contract(self.points, muscle.contraction * activation, muscle.fixed_at, along)
        place = self.skin.arc * (SAMPLES - 1)
        before = np.minimum(place.astype(np.int64), SAMPLES - 2)
        far = (place - before)[:, None]
        there = (1.0 - far) * along[before] + far * along[before + 1]
        drawn: Array = self.fibre.gain * self.skin.weight[:, None] * there
        return drawn


def whole(control: str) -> str:
    """The muscle of a control."""
    return control.removesuffix("_left").removesuffix("_right")


def _sides(muscle: Muscle) -> tuple[Side, ...]:
    if not isinstance(muscle, LinearMuscle | RingMuscle):
        return ()
    return (Side.LEFT, Side.RIGHT) if muscle.pair else (Side.LEFT,)


def _controlled(muscle: Muscle, control: str) -> tuple[Side, ...]:
    """The sides of a muscle that a control is for."""
    if control == muscle.name:
        return _sides(muscle)
    return (Side.RIGHT,) if control.endswith("_right") else (Side.LEFT,)


def _stiffness_of(anatomy: Anatomy) -> Any:
    """K of the tissue and of the edges, as they are at rest."""
    surface, springs, edges = anatomy.surface, anatomy.skin.tissue, anatomy.skin.edges
    ends = edges.edges.astype(np.int64).T
    along = surface.positions[ends[1]] - surface.positions[ends[0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    identity = np.eye(3)
    edge = edges.stiffness[:, None, None] * along[:, :, None] * along[:, None, :]
    edge += edges.shear[:, None, None] * identity
    normals, across = surface.normals, springs.normal - springs.tangential
    anchor = springs.tangential[:, None, None] * identity
    anchor += across[:, None, None] * normals[:, :, None] * normals[:, None, :]
    vertices = np.arange(surface.vertex_count)
    row = np.concatenate([ends[0], ends[1], ends[0], ends[1], vertices])
    column = np.concatenate([ends[0], ends[1], ends[1], ends[0], vertices])
    blocks = np.concatenate([edge, edge, -edge, -edge, anchor])
    axis = np.arange(3)
    rows = np.broadcast_to(3 * row[:, None, None] + axis[:, None], blocks.shape)
    columns = np.broadcast_to(3 * column[:, None, None] + axis, blocks.shape)
    shape = (3 * len(vertices),) * 2
    return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape).tocsc()


def _seal_of(anatomy: Anatomy) -> Any:
    """The springs between lips, as stiff as a grip of 1."""
    lips, count = anatomy.skin.lips, anatomy.surface.vertex_count
    pair = np.arange(len(lips.lower))
    share = np.concatenate([np.ones(len(pair)), -lips.share, lips.share - 1.0])
    ends = np.concatenate([lips.lower, lips.upper[:, 0], lips.upper[:, 1]])
    apart = sparse.coo_matrix((share, (np.tile(pair, 3), ends)), (len(pair), count)).tocsr()
    return sparse.kron(apart.T @ sparse.diags(lips.seal) @ apart, sparse.diags(SEAL_AXES)).tocsc()
