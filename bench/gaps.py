"""Do closed lips stay closed, and do lids close?

Every action unit at full strength, the left, the right and both sides where it has sides, and the
expressions in which the mouth or an eye is shut, settled on the built-in head. Of each are told
the widest slit between the lips, where nothing opens them, and the greatest height at which one
sees each eyeball that it shuts, or past it. Looked at from the whole front, 60 degrees to either
side and 40 up and down, at the mesh and at what refinement makes of it, because smoothing thins a
folded lip a little; whichever is worse.

Measured by lines of sight, not by distances between vertices: a gap that nobody can look through
is none, and one between two vertices that lie on each other may be one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius import assets, refine, sim
from risorius.app.dataset.openings import LOWER_EDGES, around, cut_by, opening, to_viewer
from risorius.app.refining.presets import FIRST_PRESET, PRESETS

from .report import Target, at_most, table
from .subjects import settled_positions

Array = npt.NDArray[np.float64]
Triangles = npt.NDArray[Any]

SETTLE = 45  # frames of 1/60 s until a pose is still
UNITS = "Action units"
# FACS: these part the lips themselves. All others leave the mouth as it is.
LIP_PARTING = ("AU9", "AU10", "AU16", "AU22", "AU25", "AU26", "AU27")
MOUTH_SHUT = ("sadness", "anger", "contempt", "wink", "kiss", "blink", "viseme_sil", "viseme_PP")
EYES_SHUT = ("yawn",)  # beside those above
SHUT = 0.99  # of the muscle that closes a lid
CLOSER = "orbicularis_oculi_palpebral_upper"
LIPS_MOST, LIDS_MOST = 0.2, 0.2  # mm: what may stay open, less than a pixel of a whole face
YAWS = (0.0, -30.0, 30.0, -60.0, 60.0)  # degrees
PITCHES = (0.0, -10.0, 10.0, -25.0, 25.0, -40.0, 40.0)
VIEWS = tuple(  # the whole front, as far as cameras go round it
    (yaw, pitch)
    for yaw, pitch in itertools.product(YAWS, PITCHES)
    if (yaw / 60.0) ** 2 + (pitch / 40.0) ** 2 < 1.3
)
MOUTH = 60.0  # mm around the mouth's middle in which skin may cover it
EYE_CORNERS = {"right": (36, 39), "left": (42, 45)}  # landmarks
LID_COLUMNS, LID_END = 23, 1.5  # planes across an eye; mm beside its corners not looked at
LID_STEP = 0.05  # mm between lines of sight in a plane
LID_WINDOW = 12.0  # mm above and below the eye's middle
EYE = 100.0  # mm around the eye's middle in which skin may cover it


class PoseGaps(NamedTuple):
    """What stays open in one pose; None where nothing ought to be shut."""

    name: str
    lips: float | None  # mm, widest slit
    lids: float | None  # mm, greatest height at which an eye that is shut is seen


def measure(head: Any = None) -> list[PoseGaps]:
    """Measure every pose, of the built-in head unless told."""
    head = assets.load("head") if head is None else head
    simulation = sim.create(head)
    told = PRESETS[FIRST_PRESET]["face"].told("kahler")
    refiner = refine.create("kahler", head.faces, head.vertices, **told)
    poses = []
    for name, is_shut in _rows(simulation):
        landmarks = settled_positions(simulation, {name: 1.0}, SETTLE)[head.landmarks]
        shut = [side for side in ("right", "left") if simulation.sums[f"{CLOSER}_{side}"] >= SHUT]
        lips, lids = [], []
        for positions, triangles in meshes_of(simulation, refiner).values():
            if is_shut:
                lips.append(widest_slit(positions, triangles, landmarks))
            if shut:
                gaps = lid_gaps(positions, triangles, landmarks, eyeballs_of(head, simulation))
                lids += [gaps[side] for side in shut]
        poses.append(PoseGaps(name, max(lips, default=None), max(lids, default=None)))
    return poses


def worst(poses: Sequence[PoseGaps], part: str) -> tuple[float, PoseGaps]:
    """The greatest value of `part`, "lips" or "lids" [mm], and the pose that has it."""
    found = [(value, pose) for pose in poses if (value := getattr(pose, part)) is not None]
    return max(found, key=lambda pair: pair[0])


def _rows(simulation: sim.Simulation) -> Iterator[tuple[str, bool]]:
    """Name of each row to look at, and whether its mouth is shut."""
    for name in simulation.layers[UNITS]:
        simulation.pose({name: 1.0})
        sums = simulation.sums
        if any(value != 0.0 for control, value in sums.items() if not control.startswith("head_")):
            yield name, name.removesuffix("_left").removesuffix("_right") not in LIP_PARTING
    for name in MOUTH_SHUT + EYES_SHUT:
        yield name, name in MOUTH_SHUT


def meshes_of(
    simulation: sim.Simulation, refiner: refine.Refiner
) -> dict[str, tuple[Array, Triangles]]:
    """Positions [mm] and triangles of the face as it is simulated ("static") and "refined"."""
    drawn = refiner.refine(simulation.positions)
    return {
        "static": (simulation.positions, simulation.faces),
        "refined": (drawn.positions.astype(np.float64), drawn.triangles),
    }


def widest_slit(positions: Array, triangles: Triangles, landmarks: Array) -> float:
    """Greatest height [mm] of the slit between the lips that one looks through from any of VIEWS.

    `landmarks`: where the 68 are now (68, 3).
    """
    lip = landmarks[list(LOWER_EDGES["mouth"])]
    near = around(positions[triangles], (lip[0] + lip[-1]) / 2.0, MOUTH)
    turns = [_turned_by(*view) for view in VIEWS]
    return max(opening(near @ turn.T, lip @ turn.T) for turn in turns)


def _turned_by(yaw: float, pitch: float) -> Array:
    """Rotation that brings the look from `yaw`, `pitch` [degrees] to the front."""
    a, b = np.radians([yaw, pitch])
    about_y = [[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]]
    about_x = [[1.0, 0.0, 0.0], [0.0, np.cos(b), -np.sin(b)], [0.0, np.sin(b), np.cos(b)]]
    return np.array(about_x) @ np.array(about_y)


def eyeballs_of(head: Any, simulation: sim.Simulation) -> dict[str, Array]:
    """Triangles (n, 3, 3) of the eyeballs that the head brings, turned as they are now, by side."""
    bones, found = simulation.bone_transforms(), {}
    for part in head.parts:
        if part.name.startswith("eyeball_"):
            turn = np.asarray(bones[part.bone], dtype=np.float64)
            x = part.vertices @ turn[:3, :3].T + turn[:3, 3]
            found[part.bone.removeprefix("eye_")] = x[part.faces]
    return found


def lid_gaps(
    positions: Array, triangles: Triangles, landmarks: Array, eyeballs: Mapping[str, Array]
) -> dict[str, float]:
    """Greatest height [mm] at which one sees each eyeball, or past it, from any of VIEWS.

    Seen is what has no skin in front of it, be it between the lids or through them: the cornea
    stands out of the ball and may pierce a lid. `landmarks`: where the 68 are now (68, 3);
    `eyeballs`: see `eyeballs_of`. The result is by the eye's side.
    """
    turns = [_turned_by(*view) for view in VIEWS]
    gaps = {}
    for side, numbers in EYE_CORNERS.items():
        ends, ball = landmarks[list(numbers)], eyeballs[side]
        near = around(positions[triangles], ends.mean(axis=0), EYE)
        gaps[side] = max(_lid_gap(near @ turn.T, ends @ turn.T, ball @ turn.T) for turn in turns)
    return gaps


def _lid_gap(near: Array, ends: Array, ball: Array) -> float:
    """Greatest height [mm] without skin between the corners of an eye (2, 3), along z.

    What has skin above and below it counts.
    """
    near = near[to_viewer(near)]
    left, right = np.sort(ends[:, 0])
    middle, deepest = ends[:, 1].mean(), ball[:, :, 2].min()
    heights = np.arange(middle - LID_WINDOW, middle + LID_WINDOW, LID_STEP)
    widest = 0
    for x in np.linspace(left + LID_END, right - LID_END, LID_COLUMNS):
        covered = _front(near, x, heights) >= np.maximum(_front(ball, x, heights), deepest)
        skin = np.flatnonzero(covered)  # beyond the outermost the head may have ended
        if len(skin):
            widest = max(widest, int((~covered[skin[0] : skin[-1]]).sum()))
    return LID_STEP * widest


def _front(triangles: Array, x: float, heights: Array) -> Array:
    """How far to the front triangles (n, 3, 3) reach in the plane at x, shape (len(heights),).

    -inf where there is none at that height.
    """
    is_crossed = (triangles[:, :, 0].min(axis=1) < x) & (triangles[:, :, 0].max(axis=1) > x)
    cut, meets = cut_by(triangles[is_crossed], x)
    y = np.where(meets, cut[:, :, 1], np.inf)
    ends = np.take_along_axis(cut, np.argsort(y, axis=1)[:, :2, None], axis=1)  # lower, upper
    low, high = ends[:, 0, 1:, None], ends[:, 1, 1:, None]
    share = (heights - low[:, 0]) / np.maximum(high[:, 0] - low[:, 0], 1e-9)
    depth = low[:, 1] + share * (high[:, 1] - low[:, 1])
    inside = (share >= 0.0) & (share <= 1.0)
    reach: Array = np.where(inside, depth, -np.inf).max(axis=0, initial=-np.inf)
    return reach


def report(poses: Sequence[PoseGaps]) -> str:
    """The text to print."""
    rows = [
        (part, value, f" {pose.name}")
        for part in ("lips", "lids")
        for value, pose in [worst(poses, part)]
    ]
    return "\n".join(
        [
            f"{len(poses)} poses of the built-in head, as simulated and as refined, the worse:",
            "lips  widest slit between lips that nothing opens, from any side in front [mm]",
            "lids  greatest height at which an eye that is shut is seen, from there, too [mm]",
            "",
            *table("pose:<14|lips:6.2f|lids:6.2f", poses, empty="-"),
            "",
            *table("worst:<6|mm:6.2f| in:<1", rows),
        ]
    )


def targets(poses: Sequence[PoseGaps]) -> list[Target]:
    """What closed lips and lids are held to."""
    most = {"lips": LIPS_MOST, "lids": LIDS_MOST}
    return [at_most(part, worst(poses, part)[0], each, " mm") for part, each in most.items()]
