"""Muscle fibres: polylines from bone to skin that follow the face, and their contraction.

A fibre is FIBRE_POINTS points p_0 (origin) .. p_n (insertion). Skin is attached to the fibre by arc
length t in 0..1. At contraction c, the point at t moves to where the point at t (1 - c) was: skin
slides along the fibre towards the origin. A muscle whose origin is the scalp (frontalis)
is fixed at t = f instead, and both ends slide towards it: t moves to f + (t - f)(1 - c). A table
holds the displacements at SAMPLE_COUNT points along every fibre; each tick rewrites it. The skin,
and muscles that lie on the fibre, read the table by linear interpolation.

                      t = 0                t (1 - c)   t                 t = 1
    origin on bone      o-------.-------.----*<--------o-------.-----------o  insertion in the skin

Before a fibre contracts, its points follow the bones and the muscles that it lies on
(muscle_stack.py).

Source: Kähler et al. 2001, section 4 (piecewise linear fibres, contraction q_i along the polyline,
u_i = max(c t_i, 0.01)).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers32, Unsigned32
from ..geometry.directions import unit_vectors
from ..geometry.vectors import (
    Vector,
    add_to_row,
    difference,
    dot,
    less,
    plus,
    rotated,
    row_of,
    times,
    toward,
    write_row,
)
from ..jit import njit
from .landmarks import Side
from .polylines import nearest_on_line, reached_along
from .rig import Fibre
from .skull import RigidMotion, moved_rigidly
from .surface import SkinSurface

FIBRE_POINTS = 9  # segments of 4-10 mm: as fine as the built-in face's triangles
SAMPLE_COUNT = 17  # places along a fibre where its displacement is known, to 0.2 mm
WRAP_NEIGHBOURS = 10  # vertices that give the place of the skin (chosen)
LEAST_ARC = 0.01  # Kähler's 0.01: the insertion never reaches the origin


class AttachedPoints(NamedTuple):
    """Points that may be attached to a muscle: the skin, or control points of a muscle above it."""

    positions: Floats64  # (n, 3) mm
    normals: Floats64  # (n, 3) normals of the skin there
    lip_side: Floats64  # (n,) of lip_lid_sides.lip_side


class Gate(NamedTuple):
    """Where a muscle may act."""

    side: float  # +1 left, -1 right: fades across the midline; 0: does not fade
    lip: float  # +1 upper, -1 lower: fades on the other lip; 0: does not fade


@njit
def gate_at(gate: Gate, lateral: float, lip_side: float) -> float:
    """Return 1 where a muscle may act, 0 where it must not move the skin.

    lateral: distance to the subject's left from the midline [mm]. lip_side: see `lip_side` of
    lip_lid_sides.py.
    """
    found = 1.0
    if gate.side != 0.0:  # fades to 0 across the midline; twins add up to 1
        midline_fade = 20.0  # mm across the midline over which a paired muscle yields to its twin
        found = min(max(0.5 + gate.side * lateral / (2.0 * midline_fade), 0.0), 1.0)
    if gate.lip != 0.0:
        # Value of the lip side field beyond which a gated muscle does not move the other lip.
        gate_ends = -0.6
        gate_full = 1.0  # value of full hold; without a fade below it, mouth corners get square
        t = (gate.lip * lip_side - gate_ends) / (gate_full - gate_ends)
        t = min(max(t, 0.0), 1.0)
        found *= t * t * (3.0 - 2.0 * t)
    return found


class FibreBundle(NamedTuple):
    """All lines of a face: the fibres of linear muscles, and one along each sphincter.

    A line comes after all lines that it lies on.
    """

    muscle: Integers32  # (B,) number of its muscle
    points: Floats64  # (B, FIBRE_POINTS, 3) mm at rest
    mandible: Floats64  # (B, FIBRE_POINTS) share of the mandible's motion
    contraction: Floats64  # (B,) share of the length lost at full activation; 0 along a sphincter
    fixed_at: Floats64  # (B,) place along the fibre that stays still


class Stack(NamedTuple):
    """The points of lines that lie on other lines; line b has the rows[b]:rows[b + 1]."""

    rows: Unsigned32  # (B + 1,)
    point: Unsigned32  # (n,) number within the carried line
    line: Unsigned32  # (n,) number of the line that carries the point
    sample: Floats64  # (n,) place along that line, in samples
    place: Floats64  # (n,) the same, in points
    weight: Floats64  # (n,) weight of the line's displacement
    steady: Floats64  # (n, 3) mm of the displacement that is linear in the activation, at 1


class LineMotion(NamedTuple):
    """Displacements of all lines [mm], rewritten each tick."""

    contracted: Floats64  # (B, SAMPLE_COUNT, 3) displacement of each active line by its contraction
    carried: Floats64  # (B, FIBRE_POINTS, 3) displacement of its points by the muscles beneath
    is_carried: Flags  # (B,) whether any muscle beneath moves

    @classmethod
    def allocate(cls, line_count: int) -> LineMotion:
        """Allocate the displacements of this many lines."""
        return cls(
            np.zeros((line_count, SAMPLE_COUNT, 3)),
            np.zeros((line_count, FIBRE_POINTS, 3)),
            np.zeros(line_count, dtype=np.bool_),
        )


def straight_fibre(fibre: Fibre, landmarks: Floats64, side: Side) -> Floats64:
    """Points of one fibre [mm], shape (FIBRE_POINTS, 3), from its origin to its insertion."""
    along = np.linspace(0.0, 1.0, FIBRE_POINTS)[:, None]
    origin = fibre.origin.position(landmarks, side)
    insertion = fibre.insertion.position(landmarks, side)
    points: Floats64 = origin * (1.0 - along) + insertion * along
    return points


def bent_to_skin(lines: Floats64, surface: SkinSurface, fractions: Floats64) -> Floats64:
    """Move lines (n, FIBRE_POINTS, 3) toward the skin near them, each by its fraction (n,)."""
    if surface.vertex_count < WRAP_NEIGHBOURS or not len(lines):
        return lines
    skin, normal = over_skin(lines.reshape(-1, 3), surface, surface.positions, surface.normals)
    normal = unit_vectors(normal)
    off = skin - lines.reshape(-1, 3)
    height = (off * normal).sum(axis=1, keepdims=True)  # of the skin above the line
    correction = (height * normal).reshape(lines.shape)
    for _ in range(2):  # a single vertex must not make a kink in a fibre
        before = correction[:, :-2]
        after = correction[:, 2:]
        correction[:, 1:-1] = 0.25 * before + 0.5 * correction[:, 1:-1] + 0.25 * after
    bent: Floats64 = lines + fractions[:, None, None] * correction
    return bent


def over_skin(points: Floats64, surface: SkinSurface, *fields: Floats64) -> tuple[Floats64, ...]:
    """Interpolate fields of the skin, (V, ...), at points (n, 3): means of the nearest vertices."""
    count = min(WRAP_NEIGHBOURS, surface.vertex_count)
    distance, vertices = surface.tree.query(points, k=range(1, count + 1))
    # The furthest neighbour has weight 0, so that a tie between two of them cannot bend a midline
    # fibre.
    relative = distance / np.maximum(distance[:, -1:], 1e-9)  # to that of the furthest
    weight = (1.0 - relative**2) ** 2 + 1e-12
    weight /= weight.sum(axis=1, keepdims=True)
    return tuple(np.einsum("nk,nk...->n...", weight, field[vertices]) for field in fields)


class FibreHold(NamedTuple):
    """How firmly points are attached to a fibre, and how they move when it contracts."""

    width: float  # mm across the fibre, of a Gaussian
    beyond: float  # mm past its end, of a Gaussian
    weight: float
    drawn: float  # how far a place at its end moves towards the fibre line, as a share
    bulge: float  # mm along the normal, of a Gaussian along the fibre
    bulge_at: float  # 0..1
    lift: float  # mm along the normal, everywhere
    gate: Gate


@njit
def hang_on_fibre(
    points: Floats64,
    hold: FibreHold,
    attached: AttachedPoints,
    weight: Floats64,
    arc: Floats64,
    steady: Floats64,
) -> None:
    """Fill the columns of an `Attachment` for the points within reach of a fibre (k, 3)."""
    cut_widths = 2.2  # widths at which the Gaussian (0.8 %) is cut to zero
    bulge_spread = 0.3  # of the fibre's length (fitted)
    end = len(points) - 1
    reached = reached_along(points)
    low = points[0].copy()
    high = points[0].copy()
    for point in points:
        for axis in range(3):
            low[axis] = min(low[axis], point[axis])
            high[axis] = max(high[axis], point[axis])
    farthest = cut_widths**2 * (hold.width**2 + hold.beyond**2)
    last = reached[end] - reached[end - 1]
    step_x, step_y, step_z = difference(points, end - 1, end)
    ahead = step_x / last, step_y / last, step_z / last
    for n in range(len(attached.positions)):
        place = row_of(attached.positions, n)
        outside = 0.0  # of the fibre's box: it reaches a tenth of the skin
        for axis in range(3):
            off = max(low[axis] - place[axis], 0.0, place[axis] - high[axis])
            outside += off * off
        if outside > farthest:
            continue
        squared, along, foot = nearest_on_line(points, reached, place)
        past = dot(less(place, 1.0, row_of(points, end)), ahead)
        reach = squared / hold.width**2
        if along >= 1.0 - 1e-12 and past > 0.0:
            beside = max(squared - past**2, 0.0)
            reach = beside / hold.width**2 + (past / hold.beyond) ** 2
        if reach >= cut_widths**2:
            continue
        held = hold.weight * np.exp(-reach) * gate_at(hold.gate, place[0], attached.lip_side[n])
        if held == 0.0:
            continue
        bulge = hold.bulge * np.exp(-(((along - hold.bulge_at) / bulge_spread) ** 2))
        bulge += hold.lift
        weight[n] = held
        arc[n] = along
        drawn = times(held * (hold.drawn * along), less(foot, 1.0, place))
        write_row(steady, n, plus(drawn, times(held * bulge, row_of(attached.normals, n))))


@njit
def move_lines(
    bundle: FibreBundle,
    stack: Stack,
    activation: Floats64,
    mandible: RigidMotion,
    motion: LineMotion,
) -> None:
    """Move all lines for one tick, each after the lines beneath it, and contract active lines.

    activation: one value for each muscle, (M,). mandible: its RigidMotion. Fills `motion`.
    """
    muscle = bundle.muscle
    contraction = bundle.contraction
    rows = stack.rows
    lines = stack.line
    is_carried = motion.is_carried
    carried = motion.carried
    contracted = motion.contracted
    moved = np.empty(bundle.points.shape[1:])
    for b in range(len(muscle)):
        is_carried[b] = False
        for row in range(rows[b], rows[b + 1]):
            c = lines[row]
            if activation[muscle[c]] > 0.0 or is_carried[c]:
                is_carried[b] = True
                break
        if is_carried[b]:
            carry_line(bundle, stack, activation, mandible.rotation, motion, b)
        a = activation[muscle[b]]
        if a > 0.0 and contraction[b] > 0.0:
            follow_bones(bundle.points[b], bundle.mandible[b], mandible, moved)
            if is_carried[b]:
                moved += carried[b]
            contract(moved, contraction[b] * a, bundle.fixed_at[b], contracted[b])


@njit
def carry_line(
    bundle: FibreBundle,
    stack: Stack,
    activation: Floats64,
    turn: Floats64,
    motion: LineMotion,
    b: int,
) -> None:
    """Fill `motion.carried[b]` with the displacement of line b by the lines beneath it."""
    muscle = bundle.muscle
    contraction = bundle.contraction
    mandible = bundle.mandible[b]
    point = stack.point
    line = stack.line
    steady = stack.steady
    sample = stack.sample
    place = stack.place
    weight = stack.weight
    contracted = motion.contracted
    carried = motion.carried
    is_carried = motion.is_carried
    own = carried[b]
    own[:] = 0.0
    for row in range(stack.rows[b], stack.rows[b + 1]):
        c = line[row]
        p = point[row]
        a = activation[muscle[c]]
        if a > 0.0:
            moved = times(a, row_of(steady, row))
            add_to_row(own, p, toward(moved, rotated(turn, moved), mandible[p]))
            if contraction[c] > 0.0:
                add_to_row(own, p, along_line(contracted[c], sample[row], weight[row]))
        if is_carried[c]:
            add_to_row(own, p, along_line(carried[c], place[row], weight[row]))


@njit
def along_line(displacements: Floats64, place: float, weight: float) -> Vector:
    """Interpolate displacements along a line (n, 3) at a fractional row; multiply by a weight."""
    before = min(int(place), len(displacements) - 2)
    far = weight * (place - before)
    near = weight - far
    return plus(
        times(near, row_of(displacements, before)), times(far, row_of(displacements, before + 1))
    )


@njit
def follow_bones(
    points: Floats64, weight: Floats64, mandible: RigidMotion, moved: Floats64
) -> None:
    """Carry the points of a line by its bones; `weight`: the mandible's weight at each point."""
    for p in range(len(points)):
        point = row_of(points, p)
        write_row(moved, p, toward(point, moved_rigidly(mandible, point), weight[p]))


@njit
def contract(moved: Floats64, lost: float, fixed_at: float, displacement: Floats64) -> None:
    """Fill `displacement` along a fibre that loses a fraction `lost` of its length.

    displacement: at the places of the table, (SAMPLE_COUNT, 3).
    """
    samples = len(displacement)
    count = len(moved)
    arc = np.empty(count)
    arc[0] = 0.0
    for p in range(1, count):
        along = difference(moved, p - 1, p)
        arc[p] = arc[p - 1] + np.sqrt(dot(along, along))
    remaining = max(1.0 - lost, LEAST_ARC)
    fixed = fixed_at * arc[count - 1]
    # `there` and `here` only grow, so each search continues from its last segment.
    near = 1
    far = 1
    for s in range(samples):
        here = arc[count - 1] * s / (samples - 1)
        there = fixed + remaining * (here - fixed)
        while near < count - 1 and arc[near] < there:
            near += 1
        while far < count - 1 and arc[far] < here:
            far += 1
        to = point_in_segment(moved, arc, near, there)
        at = point_in_segment(moved, arc, far, here)
        write_row(displacement, s, less(to, 1.0, at))


@njit
def point_in_segment(points: Floats64, arc: Floats64, end: int, place: float) -> Vector:
    """The point of a line (k, 3) at an arc length within the segment that ends at point `end`.

    arc: arc length up to each point, (k,).
    """
    start = end - 1
    share = (place - arc[start]) / max(arc[end] - arc[start], 1e-12)
    return toward(row_of(points, start), row_of(points, end), share)
