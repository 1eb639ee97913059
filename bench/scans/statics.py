"""Where the skin comes to rest, by one linear solve: what a fit of many numbers can afford.

The face of sim/ without what is not linear in its motion: contacts, biphasic stiffening, and
muscles that carry each other. At rest the forces on the skin are in balance,

    (K + hold) u = pull

with K of tissue and edges, and with hold and pull of all muscles at their activations
(sim/muscle_forces.py). Where bones and lids carry the anchors of the skin by c, what follows them,
all but the stretch of edges, pulls by its stiffness times c, too. The derivative after any number
of a rig is one more solve,

    (K + hold) du = d pull + d hold (c - u) + (K - stretch + hold) dc

On sixteen scanned shapes u has cosines of 0.98 to 1.00 to what `sim` simulates by anatomy.toml.

Source: implicit differentiation of an equilibrium.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from risorius.sim.anatomy import SEAL_BROKEN_BY_JAW, Anatomy
from risorius.sim.contact import Grip
from risorius.sim.fibres import SAMPLES, build_fibre, contract
from risorius.sim.landmarks import Side
from risorius.sim.muscles import AttachedPoints, Attachment, attach_to_fibre, attach_to_ring
from risorius.sim.rig import Eyes, Fibre, Jaw, LinearMuscle, Muscle, RingMuscle
from risorius.sim.substep import SEAL_AXES

from .bones_and_lids import carried, framed
from .muscle_numbers import Part, Parts, moved_by

Array = npt.NDArray[np.float64]

CACHED = 4096  # muscles and effects that are remembered; a fit asks for each many times


class Effect(NamedTuple):
    """What muscles, bones and lids do to the skin."""

    force: Array  # (V, 3)
    hold: Array  # (V,) stiffness that they add
    carried: Array  # (V, 3) mm that bones and lids carry the skin's anchors by

    def plus(self, other: Effect, share: float = 1.0) -> Effect:
        """Both at once."""
        return Effect(*(own + share * its for own, its in zip(self, other, strict=True)))


class Balance(NamedTuple):
    """A pose in balance."""

    moved: Array  # (V, 3) mm
    total: Effect
    following: Any  # stiffness of all that follows bones and lids
    factors: Any  # of the stiffness matrix

    def derivatives(self, changes: list[Effect]) -> Array:
        """How the skin moves for small changes of the effect, shape (V, 3, n)."""
        own = self.total.carried - self.moved
        loads = [each.force + each.hold[:, None] * own for each in changes]
        loaded = np.stack([load.ravel() for load in loads], axis=1)
        for column, each in enumerate(changes):
            if each.carried.any():
                loaded[:, column] += self.following @ each.carried.ravel()
        found: Array = self.factors.solve(loaded)
        return found.reshape(-1, 3, len(changes))


class Statics:
    """A face whose muscles can be exchanged, and poses of it in balance."""

    def __init__(self, anatomy: Anatomy) -> None:
        self._anatomy = anatomy
        surface, tissue = anatomy.surface, anatomy.rig.tissue
        self._places = AttachedPoints(surface.positions, surface.normals, anatomy.lip_side)
        self._strength = tissue.stiffness_scale * surface.areas
        self._stretch, self._following = _stiffness_of(anatomy)
        self._seal = _seal_of(anatomy)
        self._framed = lru_cache(CACHED)(self._frame)
        self._attached = lru_cache(CACHED)(self._attach)
        self._known_effect = lru_cache(CACHED)(self._effect_of)

    def balance(self, parts: Parts, values: Mapping[str, float]) -> Balance:
        """Let the skin come to rest under some controls, all other muscles relaxed."""
        total, seal = self._nothing(), 1.0
        lids = self._framed(parts["eyes"]).lids
        if lids is not None:
            np.add.at(total.hold, lids.vertices.vertex, lids.hold)
        for muscle in (each for each in parts.values() if isinstance(each, Muscle)):
            for side in _sides(muscle):
                hold, tone = self._attached(muscle, side)[0], self._anatomy.rig.tissue.passive
                total = total._replace(hold=total.hold + muscle.tone * tone * hold)
        for control, value in values.items():
            part = parts[moved_by(control, parts)]
            total = total.plus(self.effect(part, control, value))
            if control == "jaw_open":
                seal *= max(1.0 - value / SEAL_BROKEN_BY_JAW, 0.0)
            if isinstance(part, Muscle):
                seal *= (1.0 - value * part.opens_lips) ** len(_controlled(part, control))
        following = self._following + sparse.diags(np.repeat(total.hold, 3))
        matrix = following + self._stretch
        matrix = matrix + Grip.of(max(seal, 0.0), 0.0).stiffness * self._seal
        factors = splu(
            matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )  # fmt: skip
        load = total.force.ravel() + following @ total.carried.ravel()
        return Balance(factors.solve(load).reshape(-1, 3), total, following, factors)

    def effect(self, part: Part, control: str, value: float) -> Effect:
        """What a part does at a value of its control, on the sides that it is for."""
        total = self._nothing()
        if not isinstance(part, Muscle):
            moved = carried(self._framed(part), control, value)
            return total._replace(hold=moved.hold, carried=moved.by)
        activation = value ** (self._anatomy.rig.tissue.drive_power * part.drive)
        for side in _controlled(part, control):
            total = total.plus(self._known_effect(part, side, activation))
        return total

    def _nothing(self) -> Effect:
        none = np.zeros((self._anatomy.surface.vertex_count, 3))
        return Effect(none, none[:, 0].copy(), none)

    def _frame(self, part: Jaw | Eyes) -> Anatomy:
        """The face with another jaw or other lids."""
        other = {"jaw": part} if isinstance(part, Jaw) else {"eyes": part}
        return framed(self._anatomy, replace(self._anatomy.rig, **other))

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

    def _effect_of(self, muscle: Muscle, side: Side, activation: float) -> Effect:
        """What a muscle does on one side."""
        hold, steady, strands = self._attached(muscle, side)
        passive = self._anatomy.rig.tissue.passive * muscle.tone
        force = activation * steady
        for strand in strands:
            force = force + strand.drawn(muscle, activation)
        force *= (passive + (1.0 - passive) * activation) * muscle.stiffness
        hold = (1.0 - passive) * activation * hold
        return self._nothing()._replace(force=force * self._strength[:, None], hold=hold)


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


def _sides(muscle: Muscle) -> tuple[Side, ...]:
    if not isinstance(muscle, LinearMuscle | RingMuscle):
        return ()
    return (Side.LEFT, Side.RIGHT) if muscle.pair else (Side.LEFT,)


def _controlled(muscle: Muscle, control: str) -> tuple[Side, ...]:
    """The sides of a muscle that a control is for."""
    if control == muscle.name:
        return _sides(muscle)
    return (Side.RIGHT,) if control.endswith("_right") else (Side.LEFT,)


def _stiffness_of(anatomy: Anatomy) -> tuple[Any, Any]:
    """K of the edges' stretch, and of what follows bones and lids, as they are at rest."""
    surface, springs, edges = anatomy.surface, anatomy.skin.tissue, anatomy.skin.edges
    ends = edges.edges.astype(np.int64).T
    along = surface.positions[ends[1]] - surface.positions[ends[0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    stretch = edges.stiffness[:, None, None] * along[:, :, None] * along[:, None, :]
    shear = edges.shear[:, None, None] * np.eye(3)
    normals, across = surface.normals, springs.normal - springs.tangential
    anchor = springs.tangential[:, None, None] * np.eye(3)
    anchor += across[:, None, None] * normals[:, :, None] * normals[:, None, :]
    return _assembled(ends, stretch, np.zeros_like(anchor)), _assembled(ends, shear, anchor)


def _assembled(ends: npt.NDArray[np.int64], between: Array, own: Array) -> Any:
    """Blocks (E, 3, 3) of springs between vertices, `ends` (2, E), and (V, 3, 3) of each alone."""
    vertices, axis = np.arange(len(own)), np.arange(3)
    row = np.concatenate([*ends, *ends, vertices])
    column = np.concatenate([*ends, *ends[::-1], vertices])
    blocks = np.concatenate([between, between, -between, -between, own])
    rows = np.broadcast_to(3 * row[:, None, None] + axis[:, None], blocks.shape)
    columns = np.broadcast_to(3 * column[:, None, None] + axis, blocks.shape)
    shape = (3 * len(own),) * 2
    return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape).tocsc()


def _seal_of(anatomy: Anatomy) -> Any:
    """The springs between lips, as stiff as a grip of 1."""
    lips, count = anatomy.skin.lips, anatomy.surface.vertex_count
    pair = np.arange(len(lips.lower))
    share = np.concatenate([np.ones(len(pair)), -lips.share, lips.share - 1.0])
    ends = np.concatenate([lips.lower, lips.upper[:, 0], lips.upper[:, 1]])
    apart = sparse.coo_matrix((share, (np.tile(pair, 3), ends)), (len(pair), count)).tocsr()
    return sparse.kron(apart.T @ sparse.diags(lips.seal) @ apart, sparse.diags(SEAL_AXES)).tocsc()
