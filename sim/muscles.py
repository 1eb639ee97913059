"""Muscles: place a rig's fibres and sphincters in a face, and attach the skin to them.

Linear muscles attach the skin around each of their fibres (fibres.py). Sphincters draw skin on an
elliptic ring to a centre, q = p* + (1 - c a)(p - p*); a centre in front of the lips makes them
protrude. Upper and lower half are separate muscles. Both kinds bulge the skin as they contract. A
muscle that lies on another is attached to it in the same way (muscle_stack.py).

Source: Kähler et al. 2001, section 4: linear muscles, sphincters, bulging. Differs from it: smooth
weights attach skin to fibre points, in the paper the nearest ellipsoid does. Bulge acts along the
skin normal. Weights were fitted to scanned expressions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Unsigned32
from ..jit import njit
from .fibres import (
    FIBRE_POINTS,
    AttachedPoints,
    FibreHold,
    Gate,
    bent_to_skin,
    gate_at,
    hang_on_fibre,
    straight_fibre,
)
from .landmarks import Side
from .polylines import arcs_along
from .rig import MOUTH_POINT, Fibre, LinearMuscle, Muscle, Rig, RingMuscle
from .skull import LATERAL_AXIS, UP_AXIS, rotation
from .surface import SkinSurface


class LineHold(NamedTuple):
    """The skin that is attached to a line, for drawing; empty if there is none."""

    vertices: Unsigned32  # (n,)
    weight: Floats64  # (k, n) of each vertex at the line's k points, with sum 1


Ring = Callable[[], LineHold]  # finds the skin along a sphincter; used only for drawing


class Attachment(NamedTuple):
    """How points are attached to one line of a muscle."""

    weight: Floats64  # (n,)
    arc: Floats64  # (n,) place along the line, 0..1
    steady: Floats64  # (n, 3) mm x weight: the displacement linear in the activation, at 1


@dataclass(frozen=True)
class PlacedLine:
    """A fibre in a face, or the line along a sphincter."""

    points: Floats64  # (FIBRE_POINTS, 3) mm
    fibre: Fibre | None  # None: a sphincter
    skin: Attachment  # how the skin hangs on it


@dataclass(frozen=True)
class PlacedMuscle:
    """One muscle on one side of a face and its attachment to the skin, per vertex."""

    name: str  # of its control
    muscle: LinearMuscle | RingMuscle
    side: Side
    lines: tuple[PlacedLine, ...]
    ring: Ring | None = None

    @property
    def weight(self) -> Floats64:
        """Weight of the strongest attachment of each vertex, shape (V,)."""
        strongest: Floats64 = np.max([line.skin.weight for line in self.lines], axis=0)
        return strongest

    @property
    def steady(self) -> Floats64:
        """Displacement per activation of the linear terms, times weights [mm], shape (V, 3)."""
        total: Floats64 = np.sum([line.skin.steady for line in self.lines], axis=0)
        return total


def place_muscles(
    rig: Rig, surface: SkinSurface, landmarks: Floats64, lip_side: Floats64
) -> tuple[PlacedMuscle, ...]:
    """Place all linear and ring muscles of a rig in a face, in rig order, left before right."""
    skin = AttachedPoints(surface.positions, surface.normals, lip_side)
    laid = _laid_lines(rig, surface, landmarks)
    placed = []
    for muscle in rig.muscles:
        for name, side in sides_of(muscle):
            if isinstance(muscle, LinearMuscle):
                lines = []
                for fibre in muscle.fibres:
                    points = next(laid)
                    hold = attach_to_fibre(muscle, fibre, points, side, skin)
                    lines.append(PlacedLine(points, fibre, hold))
                placed.append(PlacedMuscle(name, muscle, side, tuple(lines)))
            elif isinstance(muscle, RingMuscle):
                points = next(laid)
                hold = attach_to_ring(muscle, points, landmarks, side, skin)
                line = PlacedLine(points, None, hold)
                ring = partial(_skin_of_ring, muscle, skin.positions, landmarks, hold.weight, side)
                placed.append(PlacedMuscle(name, muscle, side, (line,), cache(ring)))
    return tuple(placed)


def _laid_lines(rig: Rig, surface: SkinSurface, landmarks: Floats64) -> Iterator[Floats64]:
    """Return the lines of all muscles in rig order, bent to the skin as far as each muscle wraps.

    The skin near all lines is found in one search.
    """
    straight = []
    wraps = []
    for muscle in rig.muscles:
        for _, side in sides_of(muscle):
            if isinstance(muscle, LinearMuscle):
                straight += [straight_fibre(each, landmarks, side) for each in muscle.fibres]
                wraps += [muscle.wrap] * len(muscle.fibres)
            elif isinstance(muscle, RingMuscle):
                straight.append(_ring_line(muscle, landmarks, side))
                wraps.append(1.0)
    lines = np.array(straight, dtype=np.float64).reshape(-1, FIBRE_POINTS, 3)
    return iter(bent_to_skin(lines, surface, np.array(wraps, dtype=np.float64)))


def sides_of(muscle: Muscle) -> tuple[tuple[str, Side], ...]:
    """Control names of a muscle, each with its side."""
    if not muscle.pair:
        return ((muscle.name, Side.LEFT),)
    return ((f"{muscle.name}_left", Side.LEFT), (f"{muscle.name}_right", Side.RIGHT))


def attach(
    placed: PlacedMuscle, line: PlacedLine, landmarks: Floats64, attached: AttachedPoints
) -> Attachment:
    """Attach points to one line of a muscle in a face."""
    muscle = placed.muscle
    side = placed.side
    if isinstance(muscle, RingMuscle):
        return attach_to_ring(muscle, line.points, landmarks, side, attached)
    assert line.fibre is not None
    return attach_to_fibre(muscle, line.fibre, line.points, side, attached)


def _side_gate(muscle: Muscle, side: Side) -> Gate:
    """Where a muscle of one side may act."""
    is_divided = muscle.pair and not muscle.crosses
    lip = {"upper_lip": 1.0, "lower_lip": -1.0}.get(muscle.gate, 0.0)
    return Gate(side.sign if is_divided else 0.0, lip)


def attach_to_fibre(
    muscle: LinearMuscle, fibre: Fibre, points: Floats64, side: Side, attached: AttachedPoints
) -> Attachment:
    """Attach points to a fibre of a linear muscle; the skin slides, converges and bulges."""
    hold = FibreHold(
        width=muscle.width * fibre.width_factor,
        beyond=muscle.beyond * fibre.width_factor,
        weight=fibre.weight,
        drawn=fibre.gain * fibre.convergence * muscle.contraction,
        bulge=muscle.bulge,
        bulge_at=muscle.bulge_at,
        lift=fibre.lift,
        gate=_side_gate(muscle, side),
    )
    count = len(attached.positions)
    found = Attachment(np.zeros(count), np.zeros(count), np.zeros((count, 3)))
    hang_on_fibre(points, hold, attached, *found)
    return found


def attach_to_ring(
    muscle: RingMuscle, points: Floats64, landmarks: Floats64, side: Side, attached: AttachedPoints
) -> Attachment:
    """Attach points to a sphincter, an elliptic ring that contracts to a centre."""
    _, up, down = muscle.radii
    rho, weight = _within_ring(muscle, landmarks, side, attached)
    on = np.flatnonzero(weight)  # most of the skin lies beside the arc or on the other lip
    held = AttachedPoints(*(each[on] for each in attached))
    count = len(weight)
    found = Attachment(weight, np.zeros(count), np.zeros((count, 3)))
    found.steady[on] = weight[on, None] * _ring_pull(muscle, landmarks, side, held)
    x = held.positions
    is_around_mouth = (muscle.shape or muscle.centre) == MOUTH_POINT
    if is_around_mouth:  # between the lips both halves are equally near
        to_line = np.where(held.lip_side > 0.0, up, down) * np.maximum(1.0 - rho[on], 0.0)
        x = x + (held.lip_side * to_line)[:, None] * UP_AXIS
    found.arc[on] = arcs_along(points, x)
    return found


def _within_ring(
    muscle: RingMuscle, landmarks: Floats64, side: Side, attached: AttachedPoints
) -> tuple[Floats64, Floats64]:
    """Relative radii of points, 1 on the ellipse, and weights of their attachment, (n,)."""
    face_depth = 25.0  # mm behind the outer eye corners a ring no longer reaches the skin
    rear = float(landmarks[[36, 45], 2].mean()) - face_depth
    ellipse = (*_ellipse_centre(muscle, landmarks, side).tolist(), *muscle.radii)
    arc = (side.sign, *muscle.arc_deg)
    count = len(attached.positions)
    rho = np.zeros(count)
    weight = np.zeros(count)
    _hold_in_ring(ellipse, muscle.edge, arc, rear, _side_gate(muscle, side), attached, rho, weight)
    return rho, weight


@njit
def _hold_in_ring(
    ellipse: tuple[float, ...],
    edge: tuple[float, float],
    arc: tuple[float, ...],
    rear: float,
    gate: Gate,
    attached: AttachedPoints,
    rho: Floats64,
    weight: Floats64,
) -> None:
    """Fill the results of `_within_ring` where a sphincter holds.

    ellipse: its centre, and its radii to the side, up and down [mm]. edge: falloff outside and
    inside. arc: side, and `arc_deg` of the muscle. rear: z behind which the ring does not reach.
    """
    x, y, _, lateral, up, down = ellipse
    outside, inside = edge
    sign, at, half, fade = arc
    for n in range(len(rho)):
        place = attached.positions[n]
        may_act = gate_at(gate, place[0], attached.lip_side[n])
        if place[2] <= rear or may_act == 0.0:
            continue
        aside = place[0] - x
        height = place[1] - y
        angle = np.degrees(np.arctan2(height, aside * sign))
        off = abs((angle - at + 180.0) % 360.0 - 180.0)
        t = min(max(1.0 - (off - half) / max(fade, 1e-3), 0.0), 1.0)
        if t == 0.0:
            continue
        rho[n] = np.hypot(aside / lateral, height / (up if height > 0.0 else down))
        beyond = max(rho[n] - 1.0, 0.0) / outside
        within = max(1.0 - rho[n], 0.0) / inside
        held = np.exp(-0.5 * beyond**2) * np.exp(-0.5 * within**2)
        weight[n] = held * (t * t * (3.0 - 2.0 * t)) * may_act


def _ring_pull(
    muscle: RingMuscle, landmarks: Floats64, side: Side, attached: AttachedPoints
) -> Floats64:
    """Displacement of points by a sphincter at full activation [mm], shape (n, 3)."""
    x = attached.positions
    centre = muscle.centre.position(landmarks, side)
    pull = np.array(muscle.contraction) * (centre - x)
    if muscle.opening_width > 0.0:
        pull[:, 1] += _round_mouth(muscle, x, landmarks)
    pull += np.array(muscle.push) * (side.sign, 1.0, 1.0)
    roll, yaw = np.radians(muscle.turn_deg)
    turn = rotation(UP_AXIS, side.sign * yaw) @ rotation(LATERAL_AXIS, roll)
    pull += (x - centre) @ (turn.T - np.eye(3))
    seam = landmarks[[62, 66], 1].mean()
    mouth_round = 1.08  # half widths of the mouth at which flare and parting end
    # The flare is an ellipse through the mouth's corners, because a uniform flare gives straight
    # edges. Round an opening it goes away from it, also sideways, as lips roll out.
    corner = mouth_round * abs(landmarks[54, 0] - landmarks[48, 0]) / 2.0
    place = x[:, 0] / (_half_width(muscle, landmarks) or corner)
    across = np.sqrt(np.maximum(1.0 - place**2, 0.0))
    flare_height = 3.0  # mm from the mouth line where the flare is three quarters of its full size
    flare = muscle.flare * np.tanh((x[:, 1] - seam) / flare_height)
    pull[:, 1] += flare * across
    if muscle.opening_width > 0.0:
        pull[:, 0] += np.abs(flare) * np.sign(muscle.flare) * np.clip(place, -1.0, 1.0)
    pull += muscle.bulge * attached.normals
    return pull


def _round_mouth(muscle: RingMuscle, x: Floats64, landmarks: Floats64) -> Floats64:
    """Return how far a sphincter lifts points off the mouth line for a round opening [mm], (n,).

    Seen from the front, the opening is an ellipse. Beside it lips are pressed together, so a funnel
    is narrower than the mouth.
    """
    seam = landmarks[[62, 66], 1].mean()
    side = {"upper_lip": 1.0, "lower_lip": -1.0}.get(muscle.gate, np.sign(x[:, 1] - seam))
    within = 1.0 - (x[:, 0] / _half_width(muscle, landmarks)) ** 2
    most_pressed = 0.33  # share of the opening's height (fitted)
    raised = np.sqrt(np.maximum(within, 0.0)) + np.clip(within, -most_pressed, 0.0)
    lifted: Floats64 = side * muscle.opening_height * raised
    return lifted


def _half_width(muscle: RingMuscle, landmarks: Floats64) -> float:
    """Half width of a sphincter's opening [mm]; 0 without one."""
    return muscle.opening_width * abs(float(landmarks[64, 0] - landmarks[60, 0])) / 2.0


def _ellipse_centre(muscle: RingMuscle, landmarks: Floats64, side: Side) -> Floats64:
    """Centre of a sphincter's ellipse."""
    return (muscle.shape or muscle.centre).position(landmarks, side)


def _ellipse_points(muscle: RingMuscle, side: Side, half_deg: float, count: int) -> Floats64:
    """Points of a sphincter's ellipse about its centre, `half_deg` to both sides, (count, 3)."""
    lateral, up, down = muscle.radii
    around = np.radians(muscle.arc_deg[0] + np.linspace(-half_deg, half_deg, count))
    height = np.where(np.sin(around) > 0.0, up, down)
    across = lateral * np.cos(around) * side.sign
    return np.stack([across, height * np.sin(around), np.zeros(count)], axis=1)


def _ring_line(muscle: RingMuscle, landmarks: Floats64, side: Side) -> Floats64:
    """The line along the part of the ellipse that a sphincter covers, shape (FIBRE_POINTS, 3)."""
    _, half, fade = muscle.arc_deg
    outline = _ellipse_points(muscle, side, min(half + fade, 180.0), FIBRE_POINTS)
    return _ellipse_centre(muscle, landmarks, side) + outline


def _skin_of_ring(
    muscle: RingMuscle, x: Floats64, landmarks: Floats64, weight: Floats64, side: Side
) -> LineHold:
    """Return the skin along the part of the ellipse that a sphincter holds firmly.

    x, weight: of the skin, and of its attachment, shapes (V, 3) and (V,).
    """
    point_count = 25
    _, half, fade = muscle.arc_deg
    outline = _ellipse_points(muscle, side, min(half + 0.5 * fade, 180.0), point_count)[:, :2]
    attached = np.flatnonzero(weight >= 0.1 * weight.max()).astype(np.uint32)
    places = _ellipse_centre(muscle, landmarks, side)[:2] + outline
    shares = skin_shares(places, x[attached, :2], weight[attached])
    smoothing_rounds = 8  # by eye: without them, the line has corners at vertices
    for _ in range(smoothing_rounds):
        before = shares[:-2]
        after = shares[2:]
        shares[1:-1] = 0.25 * before + 0.5 * shares[1:-1] + 0.25 * after
    return LineHold(attached, shares)


def skin_shares(points: Floats64, skin: Floats64, weight: Floats64) -> Floats64:
    """Return the shares (n, m) of skin (m, d) in points (n, d), near ones larger; sums are 1."""
    reach = 3.0  # [mm] beyond the nearest vertex
    squared = np.square(points[:, None] - skin).sum(axis=-1)
    nearest = squared.min(axis=1, keepdims=True, initial=np.inf if len(skin) else 0.0)
    shares = weight * np.exp((nearest - squared) / (nearest + reach**2))
    normed: Floats64 = shares / shares.sum(axis=1, keepdims=True)
    return normed
