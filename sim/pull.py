"""How contraction values become forces: one anchor per skin vertex, summed over active muscles.

Every attached vertex hangs on its muscle by a spring of stiffness k w A (muscle, attachment weight,
skin area). At activation a the spring is tightened from a passive share p to its full stiffness
and its far end is displaced:

    force = k A (p + (1 - p) a) [ w (r - x) + a d + sum_f w_f u_f(a) ]

r is the vertex at rest carried by the bones, u_f the pull of fibre f at the vertex (fibres.py), d
what is linear in a (rings, bulge, convergence to the fibre line). A tick sums this into one
stiffness and one pull per vertex, so substeps cost the same for one muscle and for fifty.

Source: Kähler et al. 2001, section 4; the passive share is our own, fitted to half activations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from .fibres import FIBRE_POINTS, LEAST_ARC, SAMPLES, FibreBundle, contract_fibres
from .landmarks import Array
from .muscles import Placed
from .rig import LinearMuscle, Rig
from .skull import Pose
from .surface import Surface

Indices = npt.NDArray[np.int32]
Unsigned = npt.NDArray[np.uint32]  # saves the kernels a test per access

LEAST_WEIGHT = 1e-2  # attachments below it are dropped


@dataclass(frozen=True)
class Attachments:
    """Vertices attached to muscles or fibres; owner m has rows[m] up to rows[m + 1]."""

    rows: Unsigned  # (owners + 1,)
    vertex: Unsigned  # (n,)
    weight: Array  # (n,) k w A
    value: Array  # (n, 3) steady displacement x k A, or (n,) place along the fibre in samples


@dataclass(frozen=True)
class MusclePull:
    """All muscles of a face, ready to pull."""

    names: tuple[str, ...]  # M control names
    passive: Array  # (M,) share of the stiffness that is there at rest
    opens_lips: Array  # (M,)
    reaches_lips: Array  # (M,) greatest attachment to the edge of a lip, 0..1
    holds: Attachments  # by muscle
    bundle: FibreBundle
    pulls: Attachments  # by fibre
    table: Array  # (B, SAMPLES, 3) displacement along each fibre, rewritten each tick
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
        bundle, holds, pulls = self.bundle, self.holds, self.pulls
        contract_fibres(
            bundle.points, bundle.mandible, bundle.contraction, bundle.fixed_at, bundle.gain,
            activation[bundle.muscle], mandible.rotation, mandible.shift, self.table,
        )  # fmt: skip
        gather(
            activation, self.passive, holds.rows, holds.vertex, holds.weight, holds.value,
            bundle.muscle, pulls.rows, pulls.vertex, pulls.weight, pulls.value, self.table,
            mandible.rotation, weight, self.steady, hold, force,
        )  # fmt: skip

    def lines(self, activation: Array, mandible: Pose, x: Array) -> dict[str, list[Array]]:
        """Polylines [mm] to draw: contracted fibres of linear muscles, skin rows of rings."""
        lines: dict[str, list[Array]] = {name: [] for name in self.names}
        for b, muscle in enumerate(self.bundle.muscle):
            points = self.bundle.points[b]
            moved = points + self.bundle.mandible[b][:, None] * mandible.displacements(points)
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
) -> MusclePull:
    """Turn placed muscles into the flat arrays of the kernels; `lips`: vertices that can touch."""
    strength = rig.tissue.stiffness_scale * surface.areas
    bundle = _bundle(placed, surface, mandible_weight)
    holds, pulls = [], []
    for at in placed:
        k = at.muscle.stiffness * strength
        holds.append((k * at.weight, k[:, None] * at.steady))
        pulls += [(k * fibre.weight, fibre.arc * (SAMPLES - 1)) for fibre in at.fibres]
    unit = strength * max((at.muscle.stiffness for at in placed), default=1.0)
    return MusclePull(
        names=tuple(at.name for at in placed),
        passive=np.array([rig.tissue.passive * at.muscle.tone for at in placed], dtype=np.float64),
        opens_lips=np.array([at.muscle.opens_lips for at in placed], dtype=np.float64),
        reaches_lips=np.array(
            [min(float(at.weight[lips].max(initial=0.0)), 1.0) for at in placed], dtype=np.float64
        ),
        holds=_attachments(holds, unit, np.zeros((0, 3))),
        bundle=bundle,
        pulls=_attachments(pulls, unit, np.zeros(0)),
        table=np.zeros((len(bundle.muscle), SAMPLES, 3)),
        steady=np.zeros((surface.vertex_count, 3)),
        rings=tuple((n, at.ring) for n, at in enumerate(placed) if at.ring is not None),
    )


def _bundle(placed: Sequence[Placed], surface: Surface, mandible_weight: Array) -> FibreBundle:
    """All fibres in muscle order; origins on their bone, insertions carried like the skin there."""
    fibres = [(n, at.muscle, fibre) for n, at in enumerate(placed) for fibre in at.fibres]
    carried, contraction, fixed_at = [], [], []
    for _, muscle, fibre in fibres:
        start = 1.0 if muscle.bone == "mandible" else 0.0
        end = mandible_weight[surface.nearest(fibre.points[-1:])[0]]
        carried.append(np.linspace(start, end, FIBRE_POINTS))
        assert isinstance(muscle, LinearMuscle)
        contraction.append(muscle.contraction)
        fixed_at.append(muscle.fixed_at)
    return FibreBundle(
        muscle=np.array([n for n, _, _ in fibres], dtype=np.int32),
        points=np.array([fibre.points for _, _, fibre in fibres]).reshape(-1, FIBRE_POINTS, 3),
        mandible=np.array(carried).reshape(-1, FIBRE_POINTS),
        contraction=np.array(contraction, dtype=np.float64),
        fixed_at=np.array(fixed_at, dtype=np.float64),
        gain=np.array([fibre.fibre.gain for _, _, fibre in fibres], dtype=np.float64),
    )


def _attachments(parts: list[tuple[Array, Array]], unit: Array, empty: Array) -> Attachments:
    """Lay the vertices that matter of each part (weight, value) end to end."""
    on = [np.flatnonzero(weight > LEAST_WEIGHT * unit) for weight, _ in parts]
    nothing = np.zeros(0, dtype=np.int64)
    return Attachments(
        rows=np.cumsum([0, *(len(rows) for rows in on)]).astype(np.uint32),
        vertex=np.concatenate([*on, nothing]).astype(np.uint32),
        weight=np.concatenate(
            [*(p[0][rows] for p, rows in zip(parts, on, strict=True)), np.zeros(0)]
        ),
        value=np.concatenate([*(p[1][rows] for p, rows in zip(parts, on, strict=True)), empty]),
    )


@numba.njit(cache=True, fastmath={"contract"})
def gather(  # type: ignore[no-untyped-def]
    activation, passive, hold_rows, hold_vertex, hold_weight, hold_steady,
    fibre_muscle, pull_rows, pull_vertex, pull_weight, pull_sample, table, turn, mandible,
    steady, hold, force,
):  # fmt: skip
    """Sum the active muscles into one stiffness and one force per vertex; `steady`: work space."""
    steady[:] = 0.0
    for m in range(len(activation)):
        a = activation[m]
        if a <= 0.0:
            continue
        grip = (1.0 - passive[m]) * a
        scale = (passive[m] + grip) * a
        for row in range(hold_rows[m], hold_rows[m + 1]):
            i = hold_vertex[row]
            hold[i] += grip * hold_weight[row]
            for k in range(3):
                steady[i, k] += scale * hold_steady[row, k]
    # Displacements that belong to the mandible turn with it: once per vertex, not per attachment.
    for i in range(len(steady)):
        sx, sy, sz = steady[i, 0], steady[i, 1], steady[i, 2]
        for k in range(3):
            turned = turn[k, 0] * sx + turn[k, 1] * sy + turn[k, 2] * sz
            force[i, k] += steady[i, k] + mandible[i] * (turned - steady[i, k])
    last = table.shape[1] - 2
    for b in range(len(fibre_muscle)):
        m = fibre_muscle[b]
        a = activation[m]
        if a <= 0.0:
            continue
        scale = passive[m] + (1.0 - passive[m]) * a
        for row in range(pull_rows[b], pull_rows[b + 1]):
            i = pull_vertex[row]
            s = min(np.uint32(pull_sample[row]), last)
            strength = scale * pull_weight[row]
            far = strength * (pull_sample[row] - s)
            near = strength - far
            for k in range(3):
                force[i, k] += near * table[b, s, k] + far * table[b, s + 1, k]
