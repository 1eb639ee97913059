"""Muscles that lie on other muscles: control points carried and lifted by the muscles beneath.

A row of the rig names the muscles that a muscle lies on (`lies_on`). Each control point of its
lines is attached to each of those muscles as skin is (muscles.py), but to one line only, the one
with the greatest weight. Let w be this weight. The foot of the point on the line has three
displacements: u along the contracting line; a s by the bulge and the other terms that are linear in
the activation a; and o' by the muscles beneath that line. The point moves by

    o = sum over muscles beneath of w (u + a s + o')  /  max(1, sum over muscles beneath of w)

So a point on one muscle follows it fully, and a point on the border of two follows their mean. The
fibre contracts along the moved points. The displacement o carries the skin of the fibre
(muscle_forces.py), whether the fibre contracts or not: the relaxed zygomaticus does not hold the
cheek back while the buccinator bulges under it. A muscle at rest moves nothing. Each line is moved
after the lines beneath it; rig.py refuses circles.

Source: Kähler et al. 2001, section 4 (muscles attached to muscles). The order of muscles: the four
layers of Freilinger et al. 1987, "Surgical anatomy of the mimic muscle system".
Differs from it: a smooth weight attaches a point to a muscle, and fades toward the muscle's border.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers64
from ..geometry.polylines import arc_lengths
from ..geometry.records import joined
from .fibres import FIBRE_POINTS, SAMPLE_COUNT, AttachedPoints, Stack, over_skin
from .muscles import PlacedLine, PlacedMuscle, attach
from .surface import SkinSurface


def bottom_up(placed: Sequence[PlacedMuscle]) -> list[int]:
    """Return the indices of the muscles, each after the muscles that it lies on."""
    muscles = {at.muscle.name: at.muscle for at in placed}
    heights: dict[str, int] = {}

    def height(name: str) -> int:
        """Return the number of muscles in the tallest stack up to this muscle."""
        if name not in heights:
            heights[name] = 1 + max((height(n) for n in muscles[name].lies_on), default=0)
        return heights[name]

    return sorted(range(len(placed)), key=lambda n: height(placed[n].muscle.name))


def stack_muscles(
    placed: Sequence[PlacedMuscle],
    order: Sequence[int],
    surface: SkinSurface,
    landmarks: Floats64,
    lip_side: Floats64,
) -> Stack:
    """Find the lines under each point of each line; `order` gives the order of muscles."""
    lines = [line for n in order for line in placed[n].lines]
    points = np.array([line.points for line in lines]).reshape(-1, FIBRE_POINTS, 3)
    normals, sides = over_skin(points.reshape(-1, 3), surface, surface.normals, lip_side)
    owners = np.repeat(order, [len(placed[n].lines) for n in order])
    lying: dict[str, list[int]] = {}  # the muscles on each muscle
    for m in order:
        for beneath in set(placed[m].muscle.lies_on):
            lying.setdefault(beneath, []).append(m)
    first = 0
    found = list[_Carried]()
    for n in order:
        above = lying.get(placed[n].muscle.name, [])
        above = [m for m in above if not _are_opposite(placed[n], placed[m])]
        if above:
            # Points are numbered through all lines, FIBRE_POINTS of each line.
            on = np.flatnonzero(np.repeat(np.isin(owners, above), FIBRE_POINTS))
            attached = AttachedPoints(points.reshape(-1, 3)[on], normals[on], sides[on])
            found.append(_attached_points(placed[n], first, landmarks, attached, on))
        first += len(placed[n].lines)
    return _stack_of(found, len(lines))


def _are_opposite(below: PlacedMuscle, above: PlacedMuscle) -> bool:
    """Return whether both muscles are of pairs, on opposite sides."""
    return below.muscle.pair and above.muscle.pair and below.side is not above.side


class _Carried(NamedTuple):
    """Points that hang on one muscle, in the columns of `Stack`."""

    at: Integers64  # (n,) number of the point, among FIBRE_POINTS of each line
    line: Integers64  # (n,)
    sample: Floats64  # (n,)
    place: Floats64  # (n,)
    weight: Floats64  # (n,)
    steady: Floats64  # (n, 3)


def _attached_points(
    beneath: PlacedMuscle,
    first: int,
    landmarks: Floats64,
    attached: AttachedPoints,
    at: Integers64,
) -> _Carried:
    """Attach the points with indices `at` to a muscle, each to its line of greatest weight.

    first: index of the muscle's first line.
    """
    holds = [attach(beneath, line, landmarks, attached) for line in beneath.lines]
    along = [points_along(line, hold.arc) for line, hold in zip(beneath.lines, holds, strict=True)]
    strongest = np.argmax([hold.weight for hold in holds], axis=0)
    chosen = strongest, np.arange(len(at))
    arcs = np.array([hold.arc for hold in holds])[chosen]
    weights = np.array([hold.weight for hold in holds])[chosen]
    steady = np.array([hold.steady for hold in holds])[chosen]
    return _Carried(
        at=at,
        line=first + strongest,
        sample=arcs * (SAMPLE_COUNT - 1),
        place=np.array(along)[chosen],
        weight=weights,
        steady=steady,
    )


def points_along(line: PlacedLine, arc: Floats64) -> Floats64:
    """Convert arc lengths 0..1 along a line to fractional indices of its points, shape (n,)."""
    reached = arc_lengths(line.points)
    positions: Floats64 = np.interp(arc * reached[-1], reached, np.arange(FIBRE_POINTS))
    return positions


def _stack_of(found: Sequence[_Carried], line_count: int) -> Stack:
    """The carried points line by line; the shares of each point sum to at most 1."""
    if not found:
        none = np.zeros(0)
        nobody = np.zeros(0, np.int64)
        found = [
            _Carried(
                at=nobody,
                line=nobody,
                sample=none,
                place=none,
                weight=none,
                steady=np.zeros((0, 3)),
            )
        ]
    points = joined(found)
    held = np.bincount(points.at, points.weight, line_count * FIBRE_POINTS)
    most = np.maximum(held, 1.0)[points.at]
    weight = points.weight / most
    least_weight = 0.02  # weight of a displacement; smaller ones are dropped
    on = np.flatnonzero(weight > least_weight)
    owner, point = np.divmod(points.at[on], FIBRE_POINTS)
    sorting = np.lexsort((point, points.line[on], owner))
    on = on[sorting]
    return Stack(
        rows=np.searchsorted(owner[sorting], np.arange(line_count + 1)).astype(np.uint32),
        point=point[sorting].astype(np.uint32),
        line=points.line[on].astype(np.uint32),
        sample=points.sample[on],
        place=points.place[on],
        weight=weight[on],
        steady=points.steady[on] / most[on, None],
    )
