"""Measure errors of sums of shapes against the simulation, and make correctives for pairs.

Programs add the displacements of shapes. In reality these do not add up: an open mouth puckers
less, and a shut lid cannot shut again. A corrective shape removes the error of a pair of shapes.
Its weight is the product of the pair's weights.

Source of correctives: Lewis, Anjyo, Rhee, Zhang, Pighin, Deng 2014, "Practice and theory of
blendshape facial models", section 4 (combination shapes).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from tqdm import tqdm

from risorius.geometry.arrays import Floats64
from risorius.geometry.normals import vertex_areas

from ..control_names import twin_of
from ..scenes import FaceScene
from ..stopping import cleaned_up_if_stopped
from .bodies import Shaped
from .poses import FacePose, rest_in

CHOSEN_SUMS = (  # sums of shapes that move the same skin
    ("jawOpen", "mouthPucker"),
    ("jawOpen", "mouthSmileLeft", "mouthSmileRight"),
    ("eyeBlinkLeft", "eyeLookDownLeft"),
    ("noseSneerLeft", "mouthUpperUpLeft"),
)
CANDIDATE_COUNT = 4  # number of simulated pairs per chosen pair
OPPOSITE_SHAPES = (("jawLeft", "jawRight"), ("mouthLeft", "mouthRight"))


@dataclass(frozen=True)
class Difference:
    """Error of a sum of shapes against the simulation.

    names: names of the shapes.
    most: greatest error of a vertex [mm].
    mean: root mean square of the error over the skin that the simulation moves [mm].
    """

    names: tuple[str, ...]
    most: float
    mean: float

    def __str__(self) -> str:
        return f"{' + '.join(self.names)}: at most {self.most:.1f} mm, RMS {self.mean:.1f}"


class Sums:
    """Sums of shapes of a scene's skin, which are compared with the simulation.

    poses: name of a shape -> its pose and its reference pose.
    corrected: pairs whose correctives are added; `poses` has their poses, too.
    """

    def __init__(
        self,
        scene: FaceScene,
        poses: Mapping[str, tuple[FacePose, FacePose]],
        corrected: Sequence[tuple[str, str]] = (),
    ) -> None:
        self._scene = scene
        self._areas = vertex_areas(scene.rest_positions, scene.faces)
        self._displacements = {name: pose.skin - base.skin for name, (pose, base) in poses.items()}
        self._corrected = corrected
        for first, second in corrected:
            self._displacements[f"{first}_{second}"] -= (
                self._displacements[first] + self._displacements[second]
            )

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """Pairs of shapes that may occur together.

        Opposite shapes, such as a look up and a look down, are left out. So are shapes whose
        control has `share_of`.
        """
        relative_to = self._scene.simulation.controls.tables.share_of
        names = [name for name in self._displacements if name not in relative_to]
        return [pair for pair in combinations(names, 2) if not _are_opposite(*pair)]

    def difference(self, names: Sequence[str]) -> Difference:
        """Return the error of the sum of some shapes at 1."""
        together = rest_in(self._scene, dict.fromkeys(names, 1.0)).skin
        displacement = together - self._scene.rest_positions
        return self._difference(tuple(names), self.sum(dict.fromkeys(names, 1.0)), displacement)

    def sum(self, weights: Mapping[str, float]) -> Floats64:
        """Return displacements of the skin [mm], (V, 3), for weights of shapes."""
        total = np.zeros_like(self._scene.rest_positions)
        for name, weight in weights.items():
            total += weight * self._displacements[name]
        for first, second in self._corrected:
            product = weights.get(first, 0.0) * weights.get(second, 0.0)
            if product:
                total += product * self._displacements[f"{first}_{second}"]
        return total

    def _difference(
        self, names: tuple[str, ...], summed: Floats64, displacement: Floats64
    ) -> Difference:
        off = np.linalg.norm(summed - displacement, axis=1)
        length = np.linalg.norm(displacement, axis=1)
        is_moved = length > 0.2 * length.max(initial=0.0)
        areas = self._areas * is_moved
        area = max(float(areas.sum()), 1e-12)
        mean_square = float((areas * off**2).sum() / area)
        greatest = float(off.max(initial=0.0))
        return Difference(names, greatest, float(np.sqrt(mean_square)))

    def shared(self, first: str, second: str) -> float:
        """Return how much skin two shapes both move [mm^4], to compare pairs."""
        by_first = np.linalg.norm(self._displacements[first], axis=1)
        by_second = np.linalg.norm(self._displacements[second], axis=1)
        return float((self._areas * by_first * by_second).sum())


def table(
    scene: FaceScene,
    poses: Mapping[str, tuple[FacePose, FacePose]],
    corrected: Sequence[tuple[str, str]] = (),
) -> list[Difference]:
    """Return the errors of CHOSEN_SUMS whose shapes exist; arguments as in `Sums`."""
    sums = Sums(scene, poses, corrected)
    return [sums.difference(names) for names in CHOSEN_SUMS if set(names) <= set(poses)]


def worth_correcting(
    scene: FaceScene, poses: Mapping[str, tuple[FacePose, FacePose]], count: int, *, progress: bool
) -> list[tuple[str, str]]:
    """Return at most `count` pairs of shapes whose sums have the greatest errors, greatest first.

    CANDIDATE_COUNT times `count` pairs are simulated: those whose shapes have most skin in common.
    """
    sums = Sums(scene, poses)
    tried = sorted(sums.pairs, key=lambda pair: -sums.shared(*pair))[: CANDIDATE_COUNT * count]
    bar = tqdm(tried, "Pairs", unit="pair", disable=not progress or None, leave=False)
    with cleaned_up_if_stopped(bar.close):
        found = [(sums.difference(pair), pair) for pair in bar]
    found.sort(key=lambda each: -each[0].mean * each[0].most)
    return [pair for _, pair in found[:count]]


def corrective_poses(
    scene: FaceScene, pairs: Sequence[tuple[str, str]]
) -> dict[str, tuple[FacePose, FacePose]]:
    """Return for each pair the pose with both shapes at 1, and the rest pose; see `corrected`."""
    rest = rest_in(scene, {})
    return {
        f"{first}_{second}": (rest_in(scene, {first: 1.0, second: 1.0}), rest)
        for first, second in pairs
    }


def corrected(shaped: Shaped, pairs: Sequence[tuple[str, str]], names: Sequence[str]) -> Shaped:
    """Subtract the shapes of each pair from the last shapes, which are the poses of the pairs."""
    if not len(shaped.targets):
        return shaped
    targets = shaped.targets.copy()
    bends = shaped.bends.copy()
    first_pair = len(names) - len(pairs)
    for number, pair in enumerate(pairs, start=first_pair):
        for name in pair:
            targets[number] -= shaped.targets[names.index(name)]
            bends[number] -= shaped.bends[names.index(name)]
    return Shaped(shaped.body, shaped.normals, targets, bends)


def _are_opposite(first: str, second: str) -> bool:
    """Whether two shapes exclude each other, or move two sides that hardly share skin."""
    if (first, second) in OPPOSITE_SHAPES or (second, first) in OPPOSITE_SHAPES:
        return True
    if twin_of(first) == second and not first.startswith("mouth"):
        return True
    return first.startswith("eyeLook") and second.startswith("eyeLook")
