"""Measures of adult faces: published means and deviations; norms.toml names their sources."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..geometry.arrays import Floats64
from .data_files import read_toml


@dataclass(frozen=True)
class NormSample:
    """Mean and deviation of one sex in a published sample [mm]."""

    mean: float
    deviation: float

    def score(self, value: float) -> float:
        """Return the distance of a value from the mean, in standard deviations."""
        return (value - self.mean) / self.deviation


@dataclass(frozen=True)
class Norm:
    """A measure of both sexes."""

    women: NormSample
    men: NormSample


NORM_ROWS = read_toml(Path(__file__).with_name("norms.toml"))
LANDMARK_PAIRS: dict[str, tuple[str, str]] = {
    code: (*row["points"],) for code, row in NORM_ROWS.items()
}
NORMS = {
    code: Norm(NormSample(*row["women"]), NormSample(*row["men"]))
    for code, row in NORM_ROWS.items()
    if "women" in row
}


def measures_of(vertices: Floats64, anatomy: Mapping[str, int]) -> dict[str, float]:
    """Return all `LANDMARK_PAIRS` between vertices (V, 3), code -> [mm].

    A measure of one side is the mean of both.
    """

    def between(first: str, second: str) -> float:
        """Distance between two points."""
        return float(np.linalg.norm(vertices[anatomy[first]] - vertices[anatomy[second]]))

    names = {name for pair in LANDMARK_PAIRS.values() for name in pair}
    right = {name: name.replace("_left", "_right") for name in names}
    measures = {}
    for code, (first, second) in LANDMARK_PAIRS.items():
        distance = between(first, second)
        if "_right" not in first + second:
            distance = 0.5 * (distance + between(right[first], right[second]))
        measures[code] = distance
    return measures
