"""Muscles that lie on other muscles: control points carried and lifted by the muscles beneath.

A row of the rig names the muscles that a muscle lies on (`lies_on`). Each control point of its
lines hangs on each of those muscles as skin does (muscles.py), but on one line only, the one that
holds it most.
With w that hold, u the displacement along the contracting line at its foot, s the bulge there and
the other terms that are linear in the activation a, and o' the displacement of that line by those
beneath it, the point moves by

    o = sum over muscles beneath of w (u + a s + o')  /  max(1, sum over muscles beneath of w)

so a point on one muscle goes all the way with it, and one on the border of two goes between them.
The fibre contracts along its points so moved, and skin that hangs on it, contracting or not, is
carried by o (muscle_forces.py): the relaxed zygomaticus does not hold the cheek back while the
buccinator bulges under it. A muscle at rest carries nothing. Lines are moved from below, each after
those that it lies on; rig.py refuses circles.

Source: Kähler et al. 2001, section 4 (muscles attached to muscles). The order of muscles: the four
layers of Freilinger et al. 1987, "Surgical anatomy of the mimic muscle system".
Differs from it: a point hangs on a muscle by a smooth weight, which fades toward its border.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..geometry.arrays import Floats64
from .fibres import FIBRE_POINTS, SAMPLES, Stack, over_skin
from .muscles import AttachedPoints, Line, PlacedMuscle, attach
from .surface import SkinSurface

Entry = tuple[int, int, float, float, float, Floats64]  # a row of Stack, in its order


def bottom_up(placed: Sequence[PlacedMuscle]) -> list[int]:
    """Numbers of the muscles in an order in which each comes after those that it lies on."""
    muscles = {at.muscle.name: at.muscle for at in placed}
    heights: dict[str, int] = {}

    def height(name: str) -> int:
        """How many muscles lie above each other up to this one."""
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
    """Find the lines under each point of each line; numbered muscle by muscle in `order`."""
    numbers = {}
    count = 0
    for n in order:
        numbers[n] = count
        count += len(placed[n].lines)
    rows = [0]
    found = list[Entry]()
    for n in order:
        beneath = {numbers[m]: placed[m] for m in numbers if _is_under(placed[m], placed[n])}
        for line in placed[n].lines:
            if not beneath:
                rows.append(len(found))
                continue
            normals, sides = over_skin(line.points, surface, surface.normals, lip_side)
            places = AttachedPoints(line.points, normals, sides)
            found += _entries(beneath, landmarks, places)
            rows.append(len(found))
    return _stack_of(rows, found)


def _is_under(below: PlacedMuscle, above: PlacedMuscle) -> bool:
    """Whether one lies on the other: a muscle of a pair on that of its own side."""
    is_beside = below.muscle.pair and above.muscle.pair and below.side is not above.side
    return below.muscle.name in above.muscle.lies_on and not is_beside


def _entries(
    beneath: dict[int, PlacedMuscle], landmarks: Floats64, places: AttachedPoints
) -> list[Entry]:
    """The lines under the points of a line, with shares that sum to at most 1 for each point.

    beneath: the muscles, by the number of their first line.
    """
    entries = list[Entry]()
    held = np.zeros(FIBRE_POINTS)
    for first, placed in beneath.items():
        holds = [attach(placed, line, landmarks, places) for line in placed.lines]
        strongest = np.argmax([hold.weight for hold in holds], axis=0)
        for f, hold in enumerate(holds):
            sample = hold.arc * (SAMPLES - 1)
            place = points_along(placed.lines[f], hold.arc)
            for p in np.flatnonzero(strongest == f).tolist():
                weight = float(hold.weight[p])
                row = p, first + f, float(sample[p]), float(place[p]), weight, hold.steady[p]
                entries.append(row)
                held[p] += weight
    most = np.maximum(held, 1.0)
    shared = [(*row[:4], row[4] / most[row[0]], row[5] / most[row[0]]) for row in entries]
    least_share = 0.02  # of a displacement: less carries nothing
    return [row for row in shared if row[4] > least_share]


def points_along(line: Line, arc: Floats64) -> Floats64:
    """Places 0..1 along a line as places among its points, 0..FIBRE_POINTS - 1, shape (n,)."""
    lengths = np.linalg.norm(np.diff(line.points, axis=0), axis=1)
    reached = np.concatenate([[0.0], np.cumsum(lengths)])
    places: Floats64 = np.interp(arc * reached[-1], reached, np.arange(FIBRE_POINTS))
    return places


def _stack_of(rows: Sequence[int], found: Sequence[Entry]) -> Stack:
    """Arrays of the entries that were found."""
    point, line, sample, place, share, steady = zip(*found, strict=True) if found else [()] * 6
    return Stack(
        rows=np.array(rows, dtype=np.uint32),
        point=np.array(point, dtype=np.uint32),
        line=np.array(line, dtype=np.uint32),
        sample=np.array(sample, dtype=np.float64),
        place=np.array(place, dtype=np.float64),
        share=np.array(share, dtype=np.float64),
        steady=np.array(steady, dtype=np.float64).reshape(-1, 3),
    )
