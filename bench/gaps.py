"""Do closed lips stay closed, do lids close, and do they rest on the eyeball instead of in it?

Every action unit at full strength, the left, the right and both sides where it has sides, and the
expressions in which the mouth or an eye is shut, settled on the built-in head. Of each are told
the widest slit between the lips, where nothing opens them; the greatest height at which one sees
each eyeball that it shuts, or past it; and how deep any skin sits in an eyeball. Looked at from the
whole front, 60 degrees to either side and 40 up and down, at the mesh and at what refinement makes
of it, with round outlines as the window shows it, whichever is worse (lines_of_sight.py).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass
from typing import Any

from risorius import assets, refine, sim
from risorius.app.refining.presets import FIRST_PRESET, PRESETS

from .lines_of_sight import eyeballs_of, lid_gaps, meshes_of, sunk_in_eyeballs, widest_slit
from .report import Target, at_most, table
from .subjects import settled_positions

SETTLE = 45  # frames of 1/60 s until a pose is still
UNITS = "Action units"
# FACS: these part the lips themselves. All others leave the mouth as it is.
LIP_PARTING = ("AU9", "AU10", "AU16", "AU22", "AU25", "AU26", "AU27")
MOUTH_SHUT = ("sadness", "anger", "contempt", "wink", "kiss", "blink", "viseme_sil", "viseme_PP")
EYES_SHUT = ("yawn",)  # beside those above
SHUT = 0.99  # of the muscle that closes a lid
CLOSER = "orbicularis_oculi_palpebral_upper"
LIPS_MOST, LIDS_MOST = 0.2, 0.2  # mm: what may stay open, less than a pixel of a whole face


@dataclass(frozen=True)
class PoseGaps:
    """What stays open in one pose; None where nothing ought to be shut."""

    name: str
    lips: float | None  # mm, widest slit
    lids: float | None  # mm, greatest height at which an eye that is shut is seen
    sunk: float  # mm that skin is deeper in an eyeball than at rest


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
        sunk = sunk_in_eyeballs(
            simulation.positions, simulation.rest_positions, simulation.faces, head.eyes
        )
        poses.append(PoseGaps(name, max(lips, default=None), max(lids, default=None), sunk))
    return poses


def worst(poses: Sequence[PoseGaps], part: str) -> tuple[float, PoseGaps]:
    """The greatest value of `part` ("lips", "lids" or "sunk") [mm] and the pose that has it."""
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


def report(poses: Sequence[PoseGaps]) -> str:
    """The text to print."""
    rows = [
        (part, value, f" {pose.name}")
        for part in ("lips", "lids", "sunk")
        for value, pose in [worst(poses, part)]
    ]
    return "\n".join(
        [
            f"{len(poses)} poses of the built-in head, as simulated and as refined, the worse:",
            "lips  widest slit between lips that nothing opens, from any side in front [mm]",
            "lids  greatest height at which an eye that is shut is seen, from there, too [mm]",
            "sunk  how deep skin lies in an eyeball, deeper than at rest [mm]",
            "",
            *table("pose:<14|lips:6.2f|lids:6.2f|sunk:6.2f", map(astuple, poses), empty="-"),
            "",
            *table("worst:<6|mm:6.2f| in:<1", rows),
        ]
    )


def targets(poses: Sequence[PoseGaps]) -> list[Target]:
    """What closed lips and lids are held to."""
    most = {"lips": LIPS_MOST, "lids": LIDS_MOST}
    return [at_most(part, worst(poses, part)[0], each, " mm") for part, each in most.items()]
