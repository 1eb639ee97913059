"""A linear model of face shapes on the built-in head's vertices, and random persons drawn from it.

A face is the mean plus a weighted sum of modes. A weight of 1 is one standard deviation of people.
The modes were fitted to the modes of ICT-FaceKit (docs/head.md). They are principal components: the
first modes move the face most. They depend on neither sex nor age. Source: Blanz, Vetter 1999, "A
morphable model for the synthesis of 3D faces".

Weights are drawn from a normal distribution. Its deviations are 1.1 to 1.2 times those of people,
except for the size of the head. Sex and age move its mean:

- The means of women and men differ as the published measures do (`assets.norms`).
- Some points move, too: brow ridge, jaw and chin of men, and sagging skin. These amounts are chosen
  by eye, as anatomists describe them.

The norms are of Europeans. So each person's mean lies at a random fraction, 0 to 1, between the
mean of the model and the means of the norms. We assume that neither this fraction nor the shape
depends on the skin tone.

Three widths of the norms were measured with calipers, which press the skin onto the bone. So the
norms give less than the width of the surface: their ratio of jaw width to the distance of the outer
eye corners is 1.15, and 1.3 on three scanned persons. PRESSED_DEPTHS corrects this. Its lengths are
chosen so that these three persons agree with the norms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from ...geometry.arrays import Floats64
from ...geometry.directions import unit_vectors
from ..data_files import read_arrays
from ..loading import load
from ..norms import NORMS, NormSample, measures_of
from .ears import USUAL_EARS, Ears, drawn_ears
from .lines import ExpressionLines, drawn_lines
from .population import EVERYBODY, Population
from .smiles import USUAL_SMILE, Smile, drawn_smile

MOST_DEVIATIONS = 2.5  # standard deviations; random numbers are clipped to this
# [mm] that calipers press, on both sides.
PRESSED_DEPTHS = {"go-go": 10.0, "zy-zy": 4.0, "ft-ft": 2.0}
AGEING_START = 30.0  # [years] from which age is visible
# Points of the left half: an anatomical name or the number of a landmark, a direction, the motion
# in ten years [mm], and the distance of a man's point from the mean of both sexes [mm]. Upward and
# forward motions are relative to the outer corner of the eye, so that a large head has no low brow.
# Points of the jaw and the corners of the mouth move by half of the difference between the
# published widths and heights.
POINTS: tuple[tuple[str | int, tuple[float, float, float], float, float], ...] = (
    (24, (0, -1, 0), 0.35, 1.4), (26, (0, -1, 0), 0.35, 1.4), (24, (0, 0, 1), 0.0, 2.6),
    ("glabella", (0, 0, 1), 0.0, 3.1), ("metopion", (0, 0, -1), 0.0, 1.6),
    ("palpebrale_superius_left", (0, -1, 0), 0.2, 0.4), ("cheek_left", (-1, 0, -1), 0.35, 1.8),
    ("cheilion_left", (0, -1, 0), 0.3, 2.2), ("labiale_superius", (0, 0, -1), 0.2, 0.6),
    ("labiale_inferius", (0, 0, -1), 0.2, 0.6), (9, (1, 0, 0), 0.0, 2.4), (10, (1, 0, 0), 0.0, 3.0),
    (11, (1, -1, 0), 0.35, 3.3), (12, (1, -1, 0), 0.35, 3.3), ("pogonion", (0, 0, 1), 0.0, 2.0),
)  # fmt: skip


class Sex(Enum):
    """A sex, which decides the norms of a face."""

    WOMAN = "woman"
    MAN = "man"


@dataclass(frozen=True)
class Identity:
    """The numbers that describe a person's face.

    - sex: decides the distribution of the weights.
    - age: also determines this distribution [years].
    - hair: factor on the lengths of the cut.
    - cut: name of the hair cut (`HAIR_CUTS` of hair.py).
    - weights: weights of the modes [standard deviations of people].
    - unevenness: added to the weights on the left side, and subtracted on the right side.
    - covered: height of the iris that the upper lid covers [mm].
    - corners: height of the mouth's corners above the centre of the lips at rest [mm].
    - brows: how far the brows are moved up [mm].
    - furrows: depth of furrows of age, relative to most people of the same age.
    - seen_lid: height of the upper lid's visible skin below the crease [mm]; negative: none shows.
    - hooding: reduction of `seen_lid` at the outer corner of the eye [mm].
    - smile: how the smile differs from the built-in one.
    - larynx: how far the larynx stands out [mm].
    - sternomastoid: how much farther this muscle stands out than the built-in head's [mm], for a
      face of usual width.
    - lines: expression lines; None: the lines of the built-in head.
    - ears: how the ears differ from those of the built-in head.
    """

    sex: Sex
    age: float
    hair: float
    cut: str
    weights: tuple[float, ...]
    unevenness: tuple[float, ...]
    covered: float = 1.6
    corners: float = 0.0
    brows: float = 0.0
    furrows: float = 1.0
    seen_lid: float = 1.4
    hooding: float = 0.0
    smile: Smile = USUAL_SMILE
    larynx: float = 0.0
    sternomastoid: float = 0.0
    lines: ExpressionLines | None = None
    ears: Ears = USUAL_EARS

    def scaled(self, factor: float) -> Identity:
        """Scale the shape's differences from the mean of people by `factor`; 0 gives the mean."""
        return replace(
            self,
            weights=tuple(factor * weight for weight in self.weights),
            unevenness=tuple(factor * weight for weight in self.unevenness),
            brows=factor * self.brows,
        )


def norms_of(sex: Sex) -> dict[str, NormSample]:
    """Return the norms of a sex: code of a measure -> mean and deviation."""
    return {code: norm.women if sex is Sex.WOMAN else norm.men for code, norm in NORMS.items()}


def scores_of(measures: Mapping[str, float], sex: Sex) -> dict[str, float]:
    """Return z-scores of measures on the surface: code -> deviation from the mean of a sex.

    measures: code -> length [mm].
    """
    return {
        code: sample.score(measures[code] - PRESSED_DEPTHS.get(code, 0.0))
        for code, sample in norms_of(sex).items()
    }


@dataclass(frozen=True)
class PersonSpace:
    """The linear model of faces: vertices = mean + sum of weights * modes."""

    mean: Floats64
    """Vertices of the mean face [mm], (V, 3)."""
    modes: Floats64
    """Displacements of the vertices by a weight of 1 [mm], (k, V, 3)."""
    slopes: Floats64
    """Changes of the measures of NORMS by a weight of 1 [mm], (m, k)."""
    pushed: Floats64
    """Motions of POINTS along their directions by a weight of 1 [mm], (n, k)."""
    anatomy: Mapping[str, int]

    def moved(self, weights: Floats64) -> Floats64:
        """Return displacements of the vertices from the mean [mm], (V, 3), for weights (k,)."""
        return np.asarray(np.tensordot(weights, self.modes, 1), dtype=np.float64)

    def draw(self, sex: Sex, age: float, random: np.random.Generator) -> Floats64:
        """Choose random weights, (k,), for a person of this sex and age [years]."""
        chance = np.clip(random.normal(size=len(self.modes)), -MOST_DEVIATIONS, MOST_DEVIATIONS)
        near_norms = float(random.uniform())
        rows, beside, apart = self._measured(sex)
        # Minimise the sum of the squared weights, of the squared deviations from the norms, and of
        # the squared distances of points from their goals. This gives linear equations.
        unit = np.eye(len(self.modes))
        # These measures count more. Without this, noses would be too long and too far forward, and
        # women's upper lips would be as high as men's.
        firmness_of = MappingProxyType({"sn-prn": 6.0, "ft-ft": 1.5, "n-sn": 4.0, "sn-ls": 5.0})
        firmly = np.array([firmness_of.get(code, 1.0) for code in NORMS])[:, None]
        mean_firmness = 4.0  # weight of published means relative to the modes
        asked = mean_firmness * (firmly * rows).T
        held = unit + asked @ rows
        middle = np.linalg.solve(held, asked @ (near_norms * beside))
        decades = max(age - AGEING_START, 0.0) / 10.0
        side = 1.0 if sex is Sex.MAN else -1.0
        far = np.array([decades * older + side * male for _, _, older, male in POINTS])
        # Changes of measures in ten years [standard deviations].
        aged_measures = MappingProxyType(
            {
                "sn-ls": 0.25,
                "ls-sto": -0.3,
                "sto-li": -0.25,
                "n-prn": 0.1,
                "al-al": 0.15,
                "ch-ch": 0.1,
            }
        )
        aged = decades * np.array([aged_measures.get(code, 0.0) for code in NORMS])
        tolerance = 0.7  # [mm] of the points' motions
        held_points = held + self.pushed.T @ self.pushed / tolerance**2
        pushes = asked @ (apart + aged) + self.pushed.T @ far / tolerance**2
        own = np.linalg.solve(held_points, pushes)
        mean = middle + own
        # Standard deviations of the first mode (the size of the head), of the second, and of the
        # fifth and all later ones; between the second and the fifth they are interpolated.
        widths = {0: 0.6, 1: 1.1, 4: 1.2}
        width = np.interp(np.arange(len(unit)), list(widths), list(widths.values()))
        most_deviations = 4.0  # bound of every weight
        return np.clip(mean + width * chance, -most_deviations, most_deviations)

    def _measured(self, sex: Sex) -> tuple[Floats64, Floats64, Floats64]:
        """Write the norms as linear equations for weights: rows (m, k), and two right sides (m,).

        All are in standard deviations of the norms. The first right side leads from the mean of
        the model to the mean of both sexes in the norms, the second from there to one sex.
        """
        found = measures_of(self.mean, self.anatomy)
        norms = norms_of(sex)
        of_model = np.array([found[code] - PRESSED_DEPTHS.get(code, 0.0) for code in NORMS])
        of_both = np.array([0.5 * (norm.women.mean + norm.men.mean) for norm in NORMS.values()])
        of_sex = np.array([sample.mean for sample in norms.values()])
        deviations = np.array([sample.deviation for sample in norms.values()])
        rows = self.slopes / deviations[:, None]
        return rows, (of_both - of_model) / deviations, (of_sex - of_both) / deviations


@lru_cache(maxsize=1)
def person_space() -> PersonSpace:
    """Read the model of faces around the mean of people from the data of the package."""
    head = load("head")
    arrays = read_arrays(head.file_beside("_modes.npz"))
    modes, own = (arrays[name].astype(np.float64) for name in ("modes", "weights"))
    mean = head.vertices - np.tensordot(own, modes, 1)
    by_mode = []  # (k, m) changes of the measures
    for mode in modes:
        more = measures_of(mean + 0.5 * mode, head.anatomy)
        less = measures_of(mean - 0.5 * mode, head.anatomy)
        by_mode.append([more[code] - less[code] for code in NORMS])
    slopes = np.ascontiguousarray(np.array(by_mode).T)
    numbers = []
    for point, *_ in POINTS:
        numbers.append(head.landmarks[point] if isinstance(point, int) else head.anatomy[point])
    directions = unit_vectors(np.array([direction for _, direction, *_ in POINTS], np.float64))
    corner = modes[:, head.anatomy["exocanthion_left"]] * [0.0, 1.0, 1.0]
    motions = modes[:, numbers] - corner[:, None]  # (k, n, 3)
    pushed = np.einsum("kni,ni->nk", motions, directions)
    return PersonSpace(mean=mean, modes=modes, slopes=slopes, pushed=pushed, anatomy=head.anatomy)


def sample_identity(
    seed: int,
    *,
    sex: Sex | None = None,
    age: float | None = None,
    is_even: bool = False,
    population: Population = EVERYBODY,
) -> Identity:
    """Choose a random identity for a person's number; a number always gives the same identity.

    - seed: number of the person, 0 or more.
    - sex, age: replace the drawn sex and the drawn age [years].
    - is_even: whether the left and the right half are alike.
    - population: population from which sex, age and cut are drawn.
    """
    random = np.random.default_rng([seed, 17])
    drawn = Sex.WOMAN if random.random() < population.women else Sex.MAN
    sex = drawn if sex is None else sex
    years = float(random.uniform(*population.ages))
    age = years if age is None else age
    hair_lengths = 0.8, 1.2  # smallest and greatest factor on the lengths of the cut
    hair = float(random.uniform(*hair_lengths))
    cuts = population.cuts_of_women if sex is Sex.WOMAN else population.cuts_of_men
    cut = str(random.choice(list(cuts), p=_normalised(cuts)))
    weights = person_space().draw(sex, age, random)
    sides = np.clip(random.normal(size=len(weights)), -MOST_DEVIATIONS, MOST_DEVIATIONS)
    unevenness = 0.1  # standard deviation of the weights that are added on the left side
    uneven = (0.0 if is_even else unevenness) * sides
    covered, corners, brows = np.clip(random.normal(size=3), -2.0, 2.0)
    furrows = float(np.clip(1.0 + 0.35 * random.normal(), 0.3, 1.7))
    late = max(age - AGEING_START, 0.0) / 10.0
    is_woman = sex is Sex.WOMAN
    seen, hooded = np.clip(random.normal(size=2), -2.0, 2.0)
    spread = 1.0 + 0.06 * late
    coverage = 1.7 - 0.3 * is_woman + 0.6 * covered + 0.15 * late
    larynx_range = (0.0, 0.8) if is_woman else (1.5, 5.0)  # [mm]
    smile = drawn_smile(is_woman, random)
    larynx = float(random.uniform(*larynx_range))
    lines = drawn_lines(not is_woman, age, random)
    leanness = np.clip(random.normal(), -2.0, 2.0)
    return Identity(
        sex=sex,
        age=age,
        hair=hair,
        cut=cut,
        weights=tuple(weights.tolist()),
        unevenness=tuple(uneven.tolist()),
        covered=float(np.clip(coverage, 0.5, 3.0)),
        corners=float(0.7 + 0.3 * is_woman + 0.65 * corners - 0.08 * late),
        brows=float(1.0 * is_woman + 1.2 * brows - 0.2 * late),
        furrows=furrows,
        seen_lid=float(1.2 + 0.5 * is_woman + spread * seen),
        hooding=float(max(0.3 + 0.5 * hooded + 0.25 * late, 0.0)),
        smile=smile,
        larynx=larynx,
        lines=lines,
        sternomastoid=float(-0.35 + 0.25 * late + 0.4 * leanness),
        ears=drawn_ears(not is_woman, age, random),
    )


def _normalised(frequencies: Mapping[str, float]) -> Floats64:
    weights = np.array(list(frequencies.values()))
    return np.asarray(weights / weights.sum())
