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


DISTANCES = {
    "n-gn": ("nasion", "gnathion"),
    "n-sn": ("nasion", "subnasale"),
    "sn-gn": ("subnasale", "gnathion"),
    "n-prn": ("nasion", "pronasale"),
    "sn-prn": ("subnasale", "pronasale"),
    "sn-sto": ("subnasale", "stomion"),
    "sn-ls": ("subnasale", "labiale_superius"),
    "ls-sto": ("labiale_superius", "stomion"),
    "sto-li": ("stomion", "labiale_inferius"),
    "li-sl": ("labiale_inferius", "sublabiale"),
    "tr-n": ("trichion", "nasion"),
    "en-en": ("endocanthion_right", "endocanthion_left"),
    "ex-ex": ("exocanthion_right", "exocanthion_left"),
    "en-ex": ("endocanthion_left", "exocanthion_left"),
    "ps-pi": ("palpebrale_superius_left", "palpebrale_inferius_left"),
    "al-al": ("alare_right", "alare_left"),
    "ch-ch": ("cheilion_right", "cheilion_left"),
    "cph-cph": ("crista_philtri_right", "crista_philtri_left"),
    "ft-ft": ("frontotemporale_right", "frontotemporale_left"),
    "zy-zy": ("zygion_right", "zygion_left"),
    "go-go": ("gonion_right", "gonion_left"),
    "t-t": ("tragion_right", "tragion_left"),
}
"""Measures by their anthropometric codes: the anatomical points between which they are taken."""

# Measures by the same codes. Not found with a deviation: sn-gn, tr-n, t-t, ps-pi.
NORMS = {
    "n-gn": Norm(Sample(118.0, 5.8, 1476), Sample(126.6, 6.6, 918)),
    "n-sn": Norm(Sample(54.5, 3.6, 1502), Sample(56.7, 3.9, 952)),
    "n-prn": Norm(Sample(47.1, 3.4, 1502), Sample(49.6, 3.9, 952)),
    "sn-prn": Norm(Sample(20.0, 1.8, 1502), Sample(20.9, 2.0, 952)),
    "sn-sto": Norm(Sample(20.3, 2.4, 1500), Sample(22.6, 2.5, 951)),
    "sn-ls": Norm(Sample(14.0, 2.4, 1501), Sample(16.3, 2.5, 951)),
    "ls-sto": Norm(Sample(7.4, 1.4, 1500), Sample(7.6, 1.6, 950)),
    "sto-li": Norm(Sample(8.6, 1.7, 1497), Sample(8.7, 2.1, 950)),
    "li-sl": Norm(Sample(10.6, 2.2, 1497), Sample(12.3, 2.5, 936)),
    "en-en": Norm(Sample(31.5, 2.7, 1498), Sample(32.7, 2.9, 949)),
    "ex-ex": Norm(Sample(85.6, 3.8, 1480), Sample(88.9, 4.1, 932)),
    "en-ex": Norm(Sample(27.8, 2.0, 1480), Sample(28.7, 1.9, 932)),
    "al-al": Norm(Sample(32.7, 2.3, 1501), Sample(35.9, 2.6, 950)),
    "ch-ch": Norm(Sample(47.9, 3.5, 1501), Sample(50.1, 3.8, 951)),
    "cph-cph": Norm(Sample(11.8, 1.7, 1501), Sample(13.1, 1.7, 949)),
    "zy-zy": Norm(Sample(130.1, 5.3, 1337), Sample(137.1, 6.3, 883)),
    "go-go": Norm(Sample(97.0, 6.5, 1382), Sample(103.7, 7.1, 898)),
    "ft-ft": Norm(Sample(105.7, 7.8, 1404), Sample(110.4, 8.4, 913)),
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
