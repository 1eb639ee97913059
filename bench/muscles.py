"""Measure where each muscle alone moves the skin, by region of the face.

Both muscles of a pair contract fully from rest. A region's motion is the mean distance that its
skin moves, weighted by area, in millimetres of a head whose outer eye corners are 89.2 mm apart.
Skin belongs to the region of the nearest of the points below, if this point is near enough.

Anatomy names the regions that a muscle may move (MOVED_REGIONS): those of its origin and insertion,
and those that the skin there draws along. Skin of all other regions must stay nearly still. So a
fit to scanned expressions cannot make one muscle do the work of another one.

Source of the regions: Standring (editor) 2020, "Gray's Anatomy", 42nd edition, chapter 36 (facial
muscles); Ekman, Friesen, Hager 2002, "Facial Action Coding System" (appearance changes).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from risorius import assets, sim
from risorius.assets.fitting import fit_head
from risorius.geometry.arrays import Floats64, Integers64
from risorius.sim.coordinates import FaceSpace
from risorius.sim.landmarks import LandmarkPoint, Side

from .report import Target, at_most, table
from .subjects import Scans, settled_positions

Mix = tuple[tuple[int, float], ...]

FARTHEST = 20.0  # [mm] of skin from the nearest point of its region
MOST_ELSEWHERE = 3.0  # [mm] mean motion of a region that a muscle must not move
SETTLING_FRAMES = 40  # frames of 1/60 s until a pose is still


def _at(landmark: int, *offset: float) -> LandmarkPoint:
    """Return the point with an offset [mm] from a landmark of the left side."""
    return _between({landmark: 1.0}, *offset)


def _between(mix: Mapping[int, float], *offset: float) -> LandmarkPoint:
    """Return the point with an offset [mm] from a weighted mean of landmarks."""
    lateral, up, forward = offset or (0.0, 0.0, 0.0)
    return LandmarkPoint(tuple(mix.items()), (lateral, up, forward))


# Region -> points on the skin of its left half.
REGION_POINTS: Mapping[str, tuple[LandmarkPoint, ...]] = {
    "forehead": (
        _at(24, 0, 22, 0), _at(22, 0, 22, 0), _at(26, 0, 18, -8), _at(24, 0, 36, -6),
        _between({21: 0.5, 22: 0.5}, 0, 20, 0), _at(22, 0, 38, -6),
    ),
    "brows": (
        _at(22, 0, 4, 0), _at(23, 0, 4, 0), _at(24, 0, 4, 0), _at(25, 0, 4, 0), _at(26, 0, 4, 0),
        _between({21: 0.5, 22: 0.5}, 0, 4, 0),
    ),
    "lids": (
        _at(42), _at(43, 0, 1, 0), _at(44, 0, 1, 0), _at(45), _at(46, 0, -1, 0),
        _at(47, 0, -1, 0),
    ),
    "nose": (
        _at(27), _at(28), _at(29), _at(30), _at(28, 7, -2, -6), _at(29, 8, -2, -8),
    ),
    "wings": (_at(35, 0, 4, 0), _at(34, 0, 2, 2), _at(33, 0, 2, 2), _at(35, 3, 2, -4)),
    "cheeks": (
        _between({45: 0.5, 54: 0.5}, 4, 4, 0), _between({46: 0.6, 54: 0.4}),
        _between({45: 0.5, 14: 0.5}, 0, -18, 0), _between({54: 0.5, 12: 0.5}, 0, 14, 0),
        _between({54: 0.5, 13: 0.5}, 0, 4, 0), _between({47: 0.5, 35: 0.5}, 6, -4, 0),
        _between({14: 0.7, 54: 0.3}),
    ),
    "upper lip": (
        _at(51, 0, 3, 0), _at(52, 0, 2, 0), _at(53, -1, 1, 0), _between({52: 0.6, 34: 0.4}),
        _between({51: 0.5, 33: 0.5}), _between({53: 0.6, 35: 0.4}), _between({62: 0.5, 51: 0.5}),
        _between({63: 0.5, 52: 0.5}),
    ),
    "corners": (_at(54), _at(54, 4, 0, -2)),
    "lower lip": (
        _at(57), _at(56), _at(55, -1, 0, 0), _between({66: 0.5, 57: 0.5}),
        _between({65: 0.5, 56: 0.5}),
    ),
    "chin": (
        _between({57: 0.55, 8: 0.45}), _between({57: 0.3, 8: 0.7}), _at(8, 0, 3, 0),
        _between({57: 0.55, 8: 0.45}, 10, 0, -2), _between({57: 0.3, 8: 0.7}, 12, 0, -2),
        _at(9, 0, 6, 2),
    ),
    "jaw": (
        _between({54: 0.5, 10: 0.5}, 2, 0, 0), _at(10, 0, 4, 2), _at(11, 0, 4, 2),
        _between({54: 0.5, 11: 0.5}, 6, 0, 0), _at(12, 0, 4, 0),
    ),
    "throat": (
        _at(8, 0, -8, -14), _at(8, 0, -16, -28), _at(9, 0, -8, -14), _at(10, 0, -10, -14),
        _at(11, 0, -12, -14), _at(8, 0, -40, -36), _at(10, 0, -35, -30),
    ),
}  # fmt: skip

# Muscle of the rig -> regions that it may move.
MOVED_REGIONS: Mapping[str, tuple[str, ...]] = {
    "frontalis_medial": ("forehead", "brows", "lids", "nose"),
    "frontalis_lateral": ("forehead", "brows", "lids"),
    "corrugator_supercilii": ("forehead", "brows", "lids"),
    "procerus": ("forehead", "brows", "nose"),
    "depressor_supercilii": ("forehead", "brows", "lids"),
    "orbicularis_oculi_orbital": ("brows", "lids", "cheeks", "corners"),
    "orbicularis_oculi_preseptal": ("lids", "cheeks"),
    "levator_labii_superioris_alaeque_nasi": (
        "nose", "wings", "cheeks", "upper lip", "corners", "lower lip",
    ),
    "nasalis": ("nose", "wings"),
    "nasalis_transverse": ("nose", "wings"),
    "levator_labii_superioris": ("wings", "cheeks", "upper lip", "corners"),
    "zygomaticus_minor": ("wings", "cheeks", "upper lip", "corners"),
    "zygomaticus_major": (
        "wings", "cheeks", "upper lip", "corners", "lower lip", "chin", "jaw",
    ),
    "levator_anguli_oris": ("wings", "cheeks", "upper lip", "corners", "lower lip"),
    "buccinator": ("cheeks", "upper lip", "corners", "lower lip", "jaw"),
    "risorius": ("cheeks", "upper lip", "corners", "lower lip", "jaw"),
    "depressor_anguli_oris": ("cheeks", "upper lip", "corners", "lower lip", "chin", "jaw"),
    "depressor_labii_inferioris": ("corners", "lower lip", "chin"),
    "mentalis": ("upper lip", "corners", "lower lip", "chin"),
    "platysma": ("corners", "lower lip", "chin", "jaw", "throat"),
    "platysma_bands": ("corners", "jaw", "throat"),
    "incisivus_labii_superioris": ("wings", "cheeks", "upper lip", "corners", "lower lip"),
    "incisivus_labii_inferioris": ("upper lip", "corners", "lower lip", "chin"),
    "orbicularis_oris_peripheral_upper": ("upper lip", "corners", "lower lip"),
    "orbicularis_oris_peripheral_lower": ("upper lip", "corners", "lower lip", "chin"),
    "orbicularis_oris_sphincter": (
        "wings", "cheeks", "upper lip", "corners", "lower lip", "chin", "jaw",
    ),
    "orbicularis_oris_marginal_upper": ("upper lip", "corners", "lower lip"),
    "orbicularis_oris_marginal_lower": ("upper lip", "corners", "lower lip", "chin"),
    "orbicularis_oris_roll_upper": ("upper lip", "corners", "lower lip"),
    "orbicularis_oris_roll_lower": ("upper lip", "corners", "lower lip", "chin"),
}  # fmt: skip


class MuscleRow(NamedTuple):
    """Mean motion [mm] of each region of a head by one muscle, in the order of REGION_POINTS."""

    head: str
    muscle: str
    motions: tuple[float, ...]

    def elsewhere(self) -> tuple[str, float]:
        """Return the region that moves most without being the muscle's, and its motion [mm]."""
        moved = dict(zip(REGION_POINTS, self.motions, strict=True))
        others = moved.keys() - set(MOVED_REGIONS[self.muscle])
        return max(((name, moved[name]) for name in sorted(others)), key=lambda pair: pair[1])


def measure(makehuman: Path | None = None, reference: Path | None = None) -> Iterator[MuscleRow]:
    """Measure each muscle of MOVED_REGIONS on the built-in head, and on heads of two folders.

    makehuman: a folder with base.obj and base.json. reference: a folder of scans.
    """
    yield from measure_head("built-in", assets.load("head"))
    if makehuman is not None:
        yield from measure_head("hm08", fit_head(makehuman / "base.obj", makehuman / "base.json"))
    if reference is not None:
        yield from measure_head("scan", Scans.read(reference).head)


def measure_head(name: str, head: Any) -> Iterator[MuscleRow]:
    """Measure each muscle on one head with landmarks and a rig."""
    simulation = sim.create(head)
    space = FaceSpace.from_landmarks(head.vertices[head.landmarks])
    rest = space.to_standard(head.vertices)
    regions = regions_of(rest, rest[head.landmarks])
    areas = simulation.areas
    for muscle in MOVED_REGIONS:
        values = {f"{muscle}_{side.value}": 1.0 for side in Side}
        positions = settled_positions(simulation, values, SETTLING_FRAMES)
        distances = np.linalg.norm(space.to_standard(positions) - rest, axis=1)
        means = []
        for number in range(len(REGION_POINTS)):
            is_there = regions == number
            mean = np.average(distances[is_there], weights=areas[is_there])
            means.append(float(mean))
        yield MuscleRow(name, muscle, tuple(means))


def regions_of(skin: Floats64, landmarks: Floats64) -> Integers64:
    """Return the index of the region of each vertex of a skin, -1 without one, shape (V,).

    skin: (V, 3), landmarks: (68, 3), both in the face space [mm].
    """
    nearest = np.full(len(skin), FARTHEST)
    regions = np.full(len(skin), -1)
    for index, points in enumerate(REGION_POINTS.values()):
        for point in points:
            for side in Side:
                distances = np.linalg.norm(skin - point.position(landmarks, side), axis=1)
                is_nearer = distances < nearest
                regions[is_nearer] = index
                nearest[is_nearer] = distances[is_nearer]
    return regions


def report(rows: list[MuscleRow]) -> str:
    """The text to print."""
    columns = "|".join(f"{name}:{max(len(name), 5)}.1f" for name in REGION_POINTS)
    lines = ["Mean motion of each region [mm] by one muscle, contracted fully on both sides"]
    for head in dict.fromkeys(row.head for row in rows):
        own = [(row.muscle, *row.motions) for row in rows if row.head == head]
        lines += ["", *table(f"{head}:<38|{columns}", own)]
    return "\n".join(lines)


def targets(rows: list[MuscleRow]) -> list[Target]:
    """The muscle of each head that moves a region without a reason most."""
    found = []
    for head in dict.fromkeys(row.head for row in rows):
        own = [row for row in rows if row.head == head]
        worst = max(own, key=lambda row: row.elsewhere()[1])
        region, motion = worst.elsewhere()
        name = f"{head}, {worst.muscle} moves {region}"
        found.append(at_most(name, motion, MOST_ELSEWHERE, " mm"))
    return found
