"""What adult faces measure: published means and deviations to compare the head with.

Only figures that were read at their source, digit by digit, are here; measures without such a
figure have none. Sources:

- Weinberg et al. 2016, "The 3D Facial Norms Database: Part 1", Cleft Palate-Craniofacial Journal
  53(6):e185-e197, doi 10.1597/15-199: 2454 persons of 3 to 40 years from four sites in the United
  States, stereophotogrammetry. The means and deviations by year of age are those tabulated in
  Cliniface (github.com/frontiersi/Cliniface, data/stats, one file for each measure); here the rows
  of 25 years, rounded to 0.1 mm.
- Kesterke et al. 2016, Biology of Sex Differences 7:23, doi 10.1186/s13293-016-0076-8, table 2:
  what was measured how. In that data zy-zy, go-go and ft-ft were taken with calipers, which press
  on the skin over the bone; a surface may read wider there.

Both describe samples, not how a face ought to be. Cross-check of one row: a systematic
review of 67 studies (pmc.ncbi.nlm.nih.gov/articles/PMC9029890) has 31.4 +- 2.5 mm for White en-en.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .model import FloatArray


@dataclass(frozen=True)
class Sample:
    """One sex of one sample.

    mean, deviation: [mm].
    size: persons of all ages behind the curve that the figures are taken from.
    """

    mean: float
    deviation: float
    size: int

    def score(self, value: float) -> float:
        """How many deviations a value lies above the mean."""
        return (value - self.mean) / self.deviation


@dataclass(frozen=True)
class Norm:
    """A measure of both sexes, after Weinberg et al. 2016."""

    women: Sample
    men: Sample


# By their anthropometric codes: the points between which they are taken, then mean, deviation [mm]
# and size of the samples of women and men. With a deviation no figure was found for the others.
MEASURES: dict[str, tuple[Any, ...]] = {
    "n-gn": ("nasion", "gnathion", (118.0, 5.8, 1476), (126.6, 6.6, 918)),
    "n-sn": ("nasion", "subnasale", (54.5, 3.6, 1502), (56.7, 3.9, 952)),
    "sn-gn": ("subnasale", "gnathion"),
    "n-prn": ("nasion", "pronasale", (47.1, 3.4, 1502), (49.6, 3.9, 952)),
    "sn-prn": ("subnasale", "pronasale", (20.0, 1.8, 1502), (20.9, 2.0, 952)),
    "sn-sto": ("subnasale", "stomion", (20.3, 2.4, 1500), (22.6, 2.5, 951)),
    "sn-ls": ("subnasale", "labiale_superius", (14.0, 2.4, 1501), (16.3, 2.5, 951)),
    "ls-sto": ("labiale_superius", "stomion", (7.4, 1.4, 1500), (7.6, 1.6, 950)),
    "sto-li": ("stomion", "labiale_inferius", (8.6, 1.7, 1497), (8.7, 2.1, 950)),
    "li-sl": ("labiale_inferius", "sublabiale", (10.6, 2.2, 1497), (12.3, 2.5, 936)),
    "tr-n": ("trichion", "nasion"),
    "en-en": ("endocanthion_right", "endocanthion_left", (31.5, 2.7, 1498), (32.7, 2.9, 949)),
    "ex-ex": ("exocanthion_right", "exocanthion_left", (85.6, 3.8, 1480), (88.9, 4.1, 932)),
    "en-ex": ("endocanthion_left", "exocanthion_left", (27.8, 2.0, 1480), (28.7, 1.9, 932)),
    "ps-pi": ("palpebrale_superius_left", "palpebrale_inferius_left"),
    "al-al": ("alare_right", "alare_left", (32.7, 2.3, 1501), (35.9, 2.6, 950)),
    "ch-ch": ("cheilion_right", "cheilion_left", (47.9, 3.5, 1501), (50.1, 3.8, 951)),
    "cph-cph": ("crista_philtri_right", "crista_philtri_left", (11.8, 1.7, 1501), (13.1, 1.7, 949)),
    "ft-ft": (
        "frontotemporale_right",
        "frontotemporale_left",
        (105.7, 7.8, 1404),
        (110.4, 8.4, 913),
    ),
    "zy-zy": ("zygion_right", "zygion_left", (130.1, 5.3, 1337), (137.1, 6.3, 883)),
    "go-go": ("gonion_right", "gonion_left", (97.0, 6.5, 1382), (103.7, 7.1, 898)),
    "t-t": ("tragion_right", "tragion_left"),
}
DISTANCES = {code: (first, second) for code, (first, second, *_) in MEASURES.items()}
NORMS = {
    code: Norm(*(Sample(*figures) for figures in samples))
    for code, (_, _, *samples) in MEASURES.items()
    if samples
}


def measures_of(vertices: FloatArray, anatomy: Mapping[str, int]) -> dict[str, float]:
    """All `DISTANCES` between vertices (V, 3), code -> [mm].

    What is taken on one side is the mean of both.
    """

    def between(first: str, second: str) -> float:
        """Their distance."""
        return float(np.linalg.norm(vertices[anatomy[first]] - vertices[anatomy[second]]))

    right = {name: name.replace("_left", "_right") for pair in DISTANCES.values() for name in pair}
    return {
        code: between(a, b)
        if "_right" in a + b
        else 0.5 * (between(a, b) + between(right[a], right[b]))
        for code, (a, b) in DISTANCES.items()
    }
