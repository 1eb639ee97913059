"""From contraction values to forces: one anchor per skin vertex, summed over active muscles.

A spring of stiffness k w A ties every attached vertex to its muscle (k of the muscle, attachment
weight w, skin area A). At activation a the stiffness grows from a passive fraction p to its full
value, and the far end is displaced:

    force = k A (p + (1 - p) a) [ w (r - x) + a d + sum_f w_f u_f(a) ]

Here r is the rest position carried by the bones, and u_f is the pull of fibre f at the vertex
(fibres.py). d is the displacement that is linear in a: rings, bulge, convergence to the fibre line.
If a muscle lies on others, r also moves with the mean displacement of its fibres by those others,
weighted by w_f (muscle_stack.py). A tick sums this into one stiffness and one pull per vertex, so
substeps cost the same for one muscle and for fifty.

Source: Kähler et al. 2001, section 4; the passive fraction is our own, fitted to half activations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers32, Unsigned32
from ..geometry.polylines import arc_lengths, polyline_at
from ..jit import njit
from .fibres import (
    FIBRE_POINTS,
    LEAST_ARC,
    SAMPLE_COUNT,
    FibreBundle,
    LineMotion,
    Stack,
    move_lines,
    over_skin,
)
from .muscle_stack import bottom_up, points_along, stack_muscles
from .muscles import LineHold, PlacedMuscle, Ring, skin_shares
from .rig import LinearMuscle, Rig
from .skull import RigidMotion
from .state import State
from .surface import SkinSurface


class Attachments(NamedTuple):
    """Vertices attached to muscles or lines; muscle or line m has the rows[m]:rows[m + 1]."""

    rows: Unsigned32  # (owners + 1,)
    vertex: Unsigned32  # (n,)
    weight: Floats64  # (n,) k w A
    value: Floats64  # (n, 3) a muscle's displacement x k A, or (n,) place along a line


class SkinAttachments(NamedTuple):
    """How the skin is attached to M muscles and to their B lines."""

    muscle: Integers32  # (B,) number of each line's muscle
    passive: Floats64  # (M,) share of the stiffness at rest
    holds: Attachments  # by muscle
    pulls: Attachments  # by line, places in samples
    carries: Attachments  # by line, places in points


@dataclass(frozen=True)
class MuscleForces:
    """All muscles of a face, ready to pull."""

    names: tuple[str, ...]  # names of the M muscles' controls
    opens_lips: Floats64  # (M,)
    slides_lips: Floats64  # (M,)
    reaches_lips: Floats64  # (M,) greatest attachment weight at a lip edge, 0..1
    bundle: FibreBundle
    stack: Stack
    skin: SkinAttachments
    rings: tuple[tuple[int, Ring], ...]  # muscle, and its ring

    def hold_of(self, factors: Floats64, vertex_count: int) -> Floats64:
        """Return the stiffness per vertex, (V,), of muscles multiplied by `factors`, (M,)."""
        holds = self.skin.holds
        weight = holds.weight * np.repeat(factors, holds.rows[1:] - holds.rows[:-1])
        hold = np.bincount(holds.vertex, weight, minlength=vertex_count)
        return hold.astype(np.float64)

    def add(
        self, activation: Floats64, mandible: RigidMotion, weight: Floats64, state: State
    ) -> None:
        """Add the active muscles' stiffness to `state.hold` and their pull to `state.pull`.

        activation: one value for each muscle, shape (M,); weight: the mandible's weight at each
        vertex, shape (V,).
        """
        move_lines(self.bundle, self.stack, activation, mandible, state.lines)
        gather(state, activation, self.skin, mandible.rotation, weight)

    def lines(
        self, activation: Floats64, mandible: RigidMotion, state: State
    ) -> dict[str, list[Floats64]]:
        """Polylines to draw [mm]: contracted fibres of linear muscles, skin along sphincters."""
        lines = self._along_sphincters(state.x)
        move_lines(self.bundle, self.stack, activation, mandible, state.lines)
        for b, muscle in self._lines_of_linear_muscles():
            points = self.bundle.points[b]
            moved = points + self.bundle.mandible[b][:, None] * mandible.displacements(points)
            if state.lines.is_carried[b]:
                moved += state.lines.carried[b]
            arc = arc_lengths(moved)
            remaining = max(1.0 - self.bundle.contraction[b] * activation[muscle], LEAST_ARC)
            fixed = self.bundle.fixed_at[b] * arc[-1]
            contracted = fixed + remaining * (arc - fixed)
            lines[self.names[muscle]].append(polyline_at(contracted, arc, moved))
        return lines

    def courses(
        self, mandible: RigidMotion, x: Floats64, rest: Floats64, held: Sequence[LineHold]
    ) -> dict[str, list[Floats64]]:
        """Lines along muscles now, from the bone to the moved skin: polylines [mm].

        x, rest: the skin now and at rest [mm], shape (V, 3). held: see `holds_of_lines`.
        The contracted fibres of `lines` end before the skin.
        """
        lines = self._along_sphincters(x)
        moved_skin = x - rest
        for b, muscle in self._lines_of_linear_muscles():
            points = self.bundle.points[b]
            bone = self.bundle.mandible[b][:, None] * mandible.displacements(points)
            vertices, weight = held[b]
            moved = points + bone
            if len(vertices):  # a line without skin follows its bone alone
                arc = arc_lengths(points)
                away = np.abs(arc / max(arc[-1], 1e-9) - self.bundle.fixed_at[b])
                skin_share = (away / max(away.max(), 1e-9))[:, None]
                moved += skin_share * (weight @ moved_skin[vertices] - bone)
            lines[self.names[muscle]].append(moved)
        return lines

    def _along_sphincters(self, x: Floats64) -> dict[str, list[Floats64]]:
        """Lines in the skin x, (V, 3) [mm], along sphincters; no lines for other muscles."""
        lines: dict[str, list[Floats64]] = {name: [] for name in self.names}
        for muscle, ring in self.rings:
            hold = ring()
            lines[self.names[muscle]].append(hold.weight @ x[hold.vertices])
        return lines

    def _lines_of_linear_muscles(self) -> list[tuple[int, int]]:
        """The number of each line of a linear muscle, and the number of its muscle."""
        rings = dict(self.rings)
        muscles = self.bundle.muscle.tolist()
        return [(b, muscle) for b, muscle in enumerate(muscles) if muscle not in rings]

    def holds_of_lines(self, rest: Floats64) -> list[LineHold]:
        """Return the skin around each line's points, with weights that fall with the distance.

        rest: skin at rest, (V, 3) [mm].
        """
        pulls = self.skin.pulls
        held = list[LineHold]()
        for points, own in zip(self.bundle.points, pairwise(pulls.rows.tolist()), strict=True):
            vertices = pulls.vertex[slice(*own)]
            shares = skin_shares(points, rest[vertices], pulls.weight[slice(*own)])
            held.append(LineHold(vertices, shares))
        return held


def build_muscle_forces(
    placed: Sequence[PlacedMuscle],
    rig: Rig,
    surface: SkinSurface,
    mandible_weight: Floats64,
    lips: Integers32,
    landmarks: Floats64,
    lip_side: Floats64,
) -> MuscleForces:
    """Turn placed muscles into the flat arrays of the kernels; `lips`: vertices that can touch."""
    strength = rig.tissue.stiffness_scale * surface.areas
    order = bottom_up(placed)
    stack = stack_muscles(placed, order, surface, landmarks, lip_side)
    bundle = _bundle_lines(placed, order, surface, mandible_weight)
    holds = []
    for at in placed:
        k = at.muscle.stiffness * strength
        holds.append((k * at.weight, k[:, None] * at.steady))
    tones = [rig.tissue.passive * at.muscle.tone for at in placed]
    lip_weights = [min(float(at.weight[lips].max(initial=0.0)), 1.0) for at in placed]
    carries = _carrying_attachments(placed, order, strength, stack)
    least_stiffness = 0.4  # per area, in units of the rig: weaker attachments are dropped
    least = least_stiffness * strength
    return MuscleForces(
        names=tuple(at.name for at in placed),
        opens_lips=np.array([at.muscle.opens_lips for at in placed], dtype=np.float64),
        slides_lips=np.array([at.muscle.slides_lips for at in placed], dtype=np.float64),
        reaches_lips=np.array(lip_weights, dtype=np.float64),
        bundle=bundle,
        stack=stack,
        skin=SkinAttachments(
            muscle=bundle.muscle,
            passive=np.array(tones, np.float64),
            holds=_attachments(holds, least, np.zeros((0, 3))),
            pulls=_attachments(_pulling_attachments(placed, order, strength), least, np.zeros(0)),
            carries=_attachments(carries, least, np.zeros(0)),
        ),
        rings=tuple((n, at.ring) for n, at in enumerate(placed) if at.ring is not None),
    )


def _bundle_lines(
    placed: Sequence[PlacedMuscle],
    order: Sequence[int],
    surface: SkinSurface,
    mandible_weight: Floats64,
) -> FibreBundle:
    """All lines, muscle by muscle in `order`.

    Origins are carried by their bone; insertions and sphincters move like the skin there.
    """
    lines = [(n, placed[n].muscle, line) for n in order for line in placed[n].lines]
    points = np.array([line.points for _, _, line in lines]).reshape(-1, FIBRE_POINTS, 3)
    (over,) = over_skin(points.reshape(-1, 3), surface, mandible_weight)
    carried = over.reshape(-1, FIBRE_POINTS)
    ends = mandible_weight[surface.nearest(points[:, -1])]
    contraction = np.zeros(len(lines))
    fixed_at = np.zeros(len(lines))
    for b, (_, muscle, _) in enumerate(lines):
        if isinstance(muscle, LinearMuscle):
            start = 1.0 if muscle.bone == "mandible" else 0.0
            carried[b] = np.linspace(start, ends[b], FIBRE_POINTS)
            contraction[b] = muscle.contraction
            fixed_at[b] = muscle.fixed_at
    return FibreBundle(
        muscle=np.array([n for n, _, _ in lines], dtype=np.int32),
        points=points,
        mandible=carried,
        contraction=contraction,
        fixed_at=fixed_at,
    )


PartOfSkin = tuple[Floats64, Floats64]  # weight k w A and value of each vertex of the skin


def _pulling_attachments(
    placed: Sequence[PlacedMuscle], order: Sequence[int], strength: Floats64
) -> list[PartOfSkin]:
    """Return the attachments of skin to each line that pulls, with gain; arcs are in samples."""
    parts: list[PartOfSkin] = []
    for n in order:
        k = placed[n].muscle.stiffness * strength
        for line in placed[n].lines:
            gain = 0.0 if line.fibre is None else line.fibre.gain  # sphincters do not pull
            parts.append((k * line.skin.weight * gain, line.skin.arc * (SAMPLE_COUNT - 1)))
    return parts


def _carrying_attachments(
    placed: Sequence[PlacedMuscle], order: Sequence[int], strength: Floats64, stack: Stack
) -> list[PartOfSkin]:
    """Return the attachments of skin to each line that lies on others; arcs are in points.

    The line of the muscle that holds a vertex most carries this vertex.
    """
    line_count = len(stack.rows) - 1
    lies = np.zeros((line_count, FIBRE_POINTS), dtype=np.bool_)
    line_of_row = np.repeat(np.arange(line_count), np.diff(stack.rows))
    lies[line_of_row, stack.point] = True
    parts: list[PartOfSkin] = []
    least_carried = 0.05  # least weight of skin that one muscle carries for another
    nothing = np.zeros(len(strength)), np.zeros(len(strength))
    for n in order:
        lines = placed[n].lines
        lies_here = lies[len(parts) : len(parts) + len(lines)]
        if not lies_here.any():
            parts += [nothing] * len(lines)
            continue
        k = placed[n].muscle.stiffness * strength
        weights = np.stack([line.skin.weight for line in lines])
        hangs_on = weights.argmax(axis=0)
        for f, line in enumerate(lines):
            is_carried = (hangs_on == f) & (weights[f] > least_carried)
            on = np.flatnonzero(is_carried)
            place = np.zeros(len(k))
            place[on] = points_along(line, line.skin.arc[on])
            before = np.minimum(place[on].astype(np.int64), FIBRE_POINTS - 2)
            lies_there = lies_here[f, before] | lies_here[f, before + 1]
            weight = np.zeros(len(k))
            weight[on] = k[on] * weights[f][on] * lies_there
            parts.append((weight, place))
    return parts


def _attachments(
    parts: list[tuple[Floats64, Floats64]], least: Floats64, empty: Floats64
) -> Attachments:
    """Concatenate the vertices with enough weight of all parts (weight, value).

    least: a greater weight is enough, (V,). empty: the value of a part without vertices.
    """
    counts = [0]
    vertices = [np.zeros(0, dtype=np.int64)]
    weights = [np.zeros(0)]
    values = [empty]
    for weight, value in parts:
        held = np.flatnonzero(weight > least)
        counts.append(len(held))
        vertices.append(held)
        weights.append(weight[held])
        values.append(value[held])
    return Attachments(
        rows=np.cumsum(counts).astype(np.uint32),
        vertex=np.concatenate(vertices).astype(np.uint32),
        weight=np.concatenate(weights),
        value=np.concatenate(values),
    )


@njit
def gather(
    state: State, activation: Floats64, skin: SkinAttachments, turn: Floats64, weight: Floats64
) -> None:
    """Add stiffness and pull of all active muscles to `state.hold` and `state.pull`."""
    gather_holds(state, activation, skin, turn, weight)
    gather_lines(state.pull, activation, skin, state.lines)


@njit(fastmath={"contract"})
def gather_holds(
    state: State, activation: Floats64, skin: SkinAttachments, turn: Floats64, weight: Floats64
) -> None:
    """Sum the terms linear in the activation into one stiffness and one force per vertex."""
    passive = skin.passive
    holds = skin.holds
    hold = state.hold
    force = state.pull
    steady = state.work
    steady[:] = 0.0
    for m in range(len(activation)):
        a = activation[m]
        if a <= 0.0:
            continue
        grip = (1.0 - passive[m]) * a
        scale = (passive[m] + grip) * a
        for row in range(holds.rows[m], holds.rows[m + 1]):
            i = holds.vertex[row]
            hold[i] += grip * holds.weight[row]
            for k in range(3):
                steady[i, k] += scale * holds.value[row, k]
    # Displacements of skin on the mandible turn with it, once per vertex instead of per attachment.
    for i in range(len(steady)):
        sx = steady[i, 0]
        sy = steady[i, 1]
        sz = steady[i, 2]
        for k in range(3):
            turned = turn[k, 0] * sx + turn[k, 1] * sy + turn[k, 2] * sz
            force[i, k] += steady[i, k] + weight[i] * (turned - steady[i, k])


@njit
def gather_lines(
    force: Floats64, activation: Floats64, skin: SkinAttachments, motion: LineMotion
) -> None:
    """Add the pull of all lines that contract, or are carried by others, to `force` (V, 3)."""
    muscle = skin.muscle
    passive = skin.passive
    pulls = skin.pulls
    carries = skin.carries
    contracted = motion.contracted
    carried = motion.carried
    is_carried = motion.is_carried
    for b in range(len(muscle)):
        a = max(activation[muscle[b]], 0.0)
        scale = passive[muscle[b]] + (1.0 - passive[muscle[b]]) * a
        if a > 0.0:
            add_pull(pulls, b, scale, contracted[b], force)
        if is_carried[b]:
            add_pull(carries, b, scale, carried[b], force)


@njit(fastmath={"contract"})
def add_pull(attached: Attachments, b: int, scale: float, along: Floats64, force: Floats64) -> None:
    """Add the displacement `along` a line, interpolated between two rows, times each attachment."""
    last = along.shape[0] - 2
    for row in range(attached.rows[b], attached.rows[b + 1]):
        i = attached.vertex[row]
        s = min(np.uint32(attached.value[row]), last)
        strength = scale * attached.weight[row]
        far = strength * (attached.value[row] - s)
        near = strength - far
        for k in range(3):
            force[i, k] += near * along[s, k] + far * along[s + 1, k]
