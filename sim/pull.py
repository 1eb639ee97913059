"""How contraction values become forces: one anchor per skin vertex, summed over active muscles.

Every attached vertex hangs on its muscle by a spring of stiffness k w A (muscle, attachment weight,
skin area). At activation a the spring is tightened from a passive share p to its full stiffness
and its far end is displaced:

    force = k A (p + (1 - p) a) [ w (r - x) + a d + sum_f w_f u_f(a) ]

r is the vertex at rest carried by the bones, u_f the pull of fibre f at the vertex (fibres.py), d
what is linear in a (rings, bulge, convergence to the fibre line). Where a muscle lies on others, r
is also carried by them: by the mean of what carries its fibres, w_f their weights (riding.py). A
tick sums this into one stiffness and one pull per vertex, so substeps cost the same for one muscle
and for fifty.

Source: Kähler et al. 2001, section 4; the passive share is our own, fitted to half activations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .fibres import FIBRE_POINTS, LEAST_ARC, SAMPLES, FibreBundle, Riding, move_lines, over_skin
from .landmarks import Array
from .muscles import Line, Placed
from .riding import from_below, lay_on_each_other, points_along
from .rig import LinearMuscle, Rig
from .skull import Pose
from .surface import Surface

Indices = npt.NDArray[np.int32]
Unsigned = npt.NDArray[np.uint32]  # saves the kernels a test per access

LEAST_STIFFNESS = 0.4  # per area, in units of the rig: attachments below it are dropped
LEAST_CARRIED = 0.05  # likewise those by which one muscle carries the skin on another


class Attachments(NamedTuple):
    """Vertices attached to muscles or lines; owner m has rows[m] up to rows[m + 1]."""

    rows: Unsigned  # (owners + 1,)
    vertex: Unsigned  # (n,)
    weight: Array  # (n,) k w A
    value: Array  # (n, 3) steady displacement x k A, or (n,) place along the line


@dataclass(frozen=True)
class MusclePull:
    """All muscles of a face, ready to pull."""

    names: tuple[str, ...]  # M control names
    passive: Array  # (M,) share of the stiffness that is there at rest
    opens_lips: Array  # (M,)
    reaches_lips: Array  # (M,) greatest attachment to the edge of a lip, 0..1
    holds: Attachments  # by muscle
    bundle: FibreBundle
    pulls: Attachments  # by line, places in samples
    table: Array  # (B, SAMPLES, 3) displacement along each fibre, rewritten each tick
    riding: Riding
    carries: Attachments  # by line, places in points
    ride: Array  # (B, FIBRE_POINTS, 3) displacement by the muscles beneath, rewritten each tick
    rides: npt.NDArray[np.bool_]  # (B,) whether there is one
    steady: Array  # (V, 3) work space
    rings: tuple[tuple[int, Indices], ...]  # muscle, skin vertices along its ring

    def hold_of(self, share: Array, vertex_count: int) -> Array:
        """Stiffness per vertex, shape (V,), with each muscle's scaled by `share` (M,)."""
        rows = self.holds.rows.astype(np.int64)
        weight = self.holds.weight * np.repeat(share, rows[1:] - rows[:-1])
        hold = np.bincount(self.holds.vertex, weight, minlength=vertex_count)
        result: Array = hold.astype(np.float64)
        return result

    def add(
        self, activation: Array, mandible: Pose, weight: Array, hold: Array, force: Array
    ) -> None:
        """Add the active muscles' stiffness to `hold` (V,) and their pull to `force` (V, 3).

        activation: of each muscle, shape (M,); weight: mandible's share of each vertex, shape (V,).
        """
        self._move(activation, mandible)
        gather_holds(
            activation, self.passive, self.holds, mandible.rotation, weight, self.steady, hold,
            force,
        )  # fmt: skip
        gather_lines(
            activation, self.passive, self.bundle.muscle, self.pulls, self.table, self.carries,
            self.ride, self.rides, force,
        )  # fmt: skip

    def _move(self, activation: Array, mandible: Pose) -> None:
        """Bring `table`, `ride` and `rides` up to date."""
        move_lines(
            self.bundle, self.riding, activation, mandible.rotation, mandible.shift, self.ride,
            self.rides, self.table,
        )  # fmt: skip

    def lines(self, activation: Array, mandible: Pose, x: Array) -> dict[str, list[Array]]:
        """Polylines [mm] to draw: contracted fibres of linear muscles, skin rows of rings."""
        lines: dict[str, list[Array]] = {name: [] for name in self.names}
        self._move(activation, mandible)
        rings = dict(self.rings)
        for b, muscle in enumerate(self.bundle.muscle):
            if muscle in rings:
                continue
            points = self.bundle.points[b]
            moved = points + self.bundle.mandible[b][:, None] * mandible.displacements(points)
            if self.rides[b]:
                moved += self.ride[b]
            arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(moved, axis=0), axis=1))])
            kept = max(1.0 - self.bundle.contraction[b] * activation[muscle], LEAST_ARC)
            fixed = self.bundle.fixed_at[b] * arc[-1]
            line = [np.interp(fixed + kept * (arc - fixed), arc, moved[:, k]) for k in range(3)]
            lines[self.names[muscle]].append(np.stack(line, axis=1))
        for muscle, row in self.rings:
            lines[self.names[muscle]].append(x[row])
        return lines


def prepare_pull(
    placed: Sequence[Placed],
    rig: Rig,
    surface: Surface,
    mandible_weight: Array,
    lips: Indices,
    landmarks: Array,
    lip_side: Array,
) -> MusclePull:
    """Turn placed muscles into the flat arrays of the kernels; `lips`: vertices that can touch."""
    strength = rig.tissue.stiffness_scale * surface.areas
    order = from_below(placed)
    riding = lay_on_each_other(placed, order, surface, landmarks, lip_side)
    bundle = _bundle(placed, order, surface, mandible_weight)
    holds = []
    for at in placed:
        k = at.muscle.stiffness * strength
        holds.append((k * at.weight, k[:, None] * at.steady))
    least = LEAST_STIFFNESS * strength
    return MusclePull(
        names=tuple(at.name for at in placed),
        passive=np.array([rig.tissue.passive * at.muscle.tone for at in placed], dtype=np.float64),
        opens_lips=np.array([at.muscle.opens_lips for at in placed], dtype=np.float64),
        reaches_lips=np.array(
            [min(float(at.weight[lips].max(initial=0.0)), 1.0) for at in placed], dtype=np.float64
        ),
        holds=_attachments(holds, least, np.zeros((0, 3))),
        bundle=bundle,
        pulls=_attachments(_pulls(placed, order, strength), least, np.zeros(0)),
        table=np.zeros((len(bundle.muscle), SAMPLES, 3)),
        riding=riding,
        carries=_attachments(_carries(placed, order, strength, riding), least, np.zeros(0)),
        ride=np.zeros(bundle.points.shape),
        rides=np.zeros(len(bundle.muscle), dtype=np.bool_),
        steady=np.zeros((surface.vertex_count, 3)),
        rings=tuple((n, at.ring) for n, at in enumerate(placed) if at.ring is not None),
    )


def _bundle(
    placed: Sequence[Placed], order: Sequence[int], surface: Surface, mandible_weight: Array
) -> FibreBundle:
    """All lines, muscle by muscle in `order`.

    Origins are on their bone; insertions and sphincters are carried like the skin there.
    """
    lines = [(n, placed[n].muscle, line) for n in order for line in placed[n].lines]
    carried, contraction, fixed_at = [], [], []
    for _, muscle, line in lines:
        if isinstance(muscle, LinearMuscle):
            start = 1.0 if muscle.bone == "mandible" else 0.0
            end = mandible_weight[surface.nearest(line.points[-1:])[0]]
            carried.append(np.linspace(start, end, FIBRE_POINTS))
        else:
            carried.append(over_skin(line.points, surface, mandible_weight))
        contraction.append(muscle.contraction if isinstance(muscle, LinearMuscle) else 0.0)
        fixed_at.append(muscle.fixed_at if isinstance(muscle, LinearMuscle) else 0.0)
    return FibreBundle(
        muscle=np.array([n for n, _, _ in lines], dtype=np.int32),
        points=np.array([line.points for _, _, line in lines]).reshape(-1, FIBRE_POINTS, 3),
        mandible=np.array(carried).reshape(-1, FIBRE_POINTS),
        contraction=np.array(contraction, dtype=np.float64),
        fixed_at=np.array(fixed_at, dtype=np.float64),
    )


def _gain(line: Line) -> float:
    """What a line pulls by; a sphincter pulls on no line."""
    return 0.0 if line.fibre is None else line.fibre.gain


Part = tuple[Array, Array]  # weight k w A and value of each vertex of the skin


def _pulls(placed: Sequence[Placed], order: Sequence[int], strength: Array) -> list[Part]:
    """How skin hangs on each line that pulls, gain included, places in samples."""
    return [
        (
            placed[n].muscle.stiffness * strength * line.skin.weight * _gain(line),
            line.skin.arc * (SAMPLES - 1),
        )
        for n in order
        for line in placed[n].lines
    ]


def _carries(
    placed: Sequence[Placed], order: Sequence[int], strength: Array, riding: Riding
) -> list[Part]:
    """How skin hangs on each line where it lies on others, places in points.

    A vertex is carried by the line of a muscle that it hangs on most.
    """
    lies = np.zeros((len(riding.rows) - 1, FIBRE_POINTS), dtype=np.bool_)
    lies[np.repeat(np.arange(len(lies)), np.diff(riding.rows)), riding.point] = True
    parts: list[Part] = []
    for n in order:
        k = placed[n].muscle.stiffness * strength
        weights = np.stack([line.skin.weight for line in placed[n].lines])
        hangs_on = weights.argmax(axis=0)
        for f, line in enumerate(placed[n].lines):
            place = points_along(line, line.skin.arc)
            before = np.minimum(place.astype(np.int64), FIBRE_POINTS - 2)
            lies_there = lies[len(parts), before] | lies[len(parts), before + 1]
            on = lies_there & (hangs_on == f) & (weights[f] > LEAST_CARRIED)
            parts.append((k * weights[f] * on, place))
    return parts


def _attachments(parts: list[tuple[Array, Array]], least: Array, empty: Array) -> Attachments:
    """Lay the vertices that matter of each part (weight, value) end to end."""
    on = [np.flatnonzero(weight > least) for weight, _ in parts]
    nothing = np.zeros(0, dtype=np.int64)
    return Attachments(
        rows=np.cumsum([0, *(len(rows) for rows in on)]).astype(np.uint32),
        vertex=np.concatenate([*on, nothing]).astype(np.uint32),
        weight=np.concatenate(
            [*(p[0][rows] for p, rows in zip(parts, on, strict=True)), np.zeros(0)]
        ),
        value=np.concatenate([*(p[1][rows] for p, rows in zip(parts, on, strict=True)), empty]),
    )


@njit(fastmath={"contract"})
def gather_holds(  # type: ignore[no-untyped-def]
    activation, passive, holds, turn, mandible, steady, hold, force
):
    """Sum what is linear in the activation into one stiffness and one force per vertex.

    `steady`: work space.
    """
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
    # Displacements that belong to the mandible turn with it: once per vertex, not per attachment.
    for i in range(len(steady)):
        sx, sy, sz = steady[i, 0], steady[i, 1], steady[i, 2]
        for k in range(3):
            turned = turn[k, 0] * sx + turn[k, 1] * sy + turn[k, 2] * sz
            force[i, k] += steady[i, k] + mandible[i] * (turned - steady[i, k])


@njit
def gather_lines(  # type: ignore[no-untyped-def]
    activation, passive, muscle, pulls, table, carries, ride, rides, force
):
    """Add the pull of all lines that contract, and of all that others carry, to `force` (V, 3)."""
    for b in range(len(muscle)):
        a = max(activation[muscle[b]], 0.0)
        scale = passive[muscle[b]] + (1.0 - passive[muscle[b]]) * a
        if a > 0.0:
            add_pull(pulls, b, scale, table[b], force)
        if rides[b]:
            add_pull(carries, b, scale, ride[b], force)


@njit(fastmath={"contract"})
def add_pull(attached, b, scale, along, force):  # type: ignore[no-untyped-def]
    """Add the displacement `along` a line, between two of its rows, times each attachment."""
    last = along.shape[0] - 2
    for row in range(attached.rows[b], attached.rows[b + 1]):
        i = attached.vertex[row]
        s = min(np.uint32(attached.value[row]), last)
        strength = scale * attached.weight[row]
        far = strength * (attached.value[row] - s)
        near = strength - far
        for k in range(3):
            force[i, k] += near * along[s, k] + far * along[s + 1, k]
