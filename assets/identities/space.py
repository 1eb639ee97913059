"""Differences between people, on the vertices of the built-in head: modes, and random persons.

A person is the mean with a weight for each mode; a weight of 1 is one deviation of people. The
modes were fitted to those of ICT-FaceKit like the head's form (docs/head.md), and turned so that
the first ones move the face most (principal components). They depend on neither sex nor age.

Weights are drawn from the distribution of people, widened 1.1 to 1.2 times except for the size of
the head. Sex and age move its mean: the sexes lie as far apart as the published measures of women
and men (`assets.norms`). Some points move, too (brow ridge, jaw and chin of men; skin that sags);
these amounts are chosen by eye, after anatomists. The norms are of Europeans. For each person, the
middle lies at a random share, 0 to 1, of the way from the mean of all people with these modes to
the means of the norms. Neither this share nor the form depends on the tone of the skin: this
independence is an assumption. Source: Blanz, Vetter 1999, "A morphable model for the synthesis of
3D faces".

Three widths were measured with calipers, which press on the skin over the bone (`norms`). A surface
is wider there: on three scanned persons the ratio of the jaw's width to the distance of the outer
eye corners is 1.3, in the norms 1.15. So the depth of this pressure is added; its amount is chosen
by these three persons.
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
from ..norms import NORMS, Sample, measures_of
from .lines import Lines, drawn_lines
from .population import EVERYBODY, Population
from .smiles import USUAL_SMILE, Smile, drawn_smile

MOST = 2.5  # deviations
PRESSED = {"go-go": 10.0, "zy-zy": 4.0, "ft-ft": 2.0}  # [mm] of calipers, both sides
YOUNG = 30.0  # [years] from which age is visible
# Points of the left half: an anatomical name or the number of a landmark, a direction, their way in
# ten years [mm], and the distance of a man's point from the mean of both sexes [mm]. Upward and
# forward they are relative to the outer corner of the eye, so that a large head has no low brow.
# Points of the jaw and the corners of the mouth have half of the difference between published
# widths and heights.
POINTS: tuple[tuple[str | int, tuple[float, float, float], float, float], ...] = (
    (24, (0, -1, 0), 0.35, 1.4), (26, (0, -1, 0), 0.35, 1.4), (24, (0, 0, 1), 0.0, 2.6),
    ("glabella", (0, 0, 1), 0.0, 3.1), ("metopion", (0, 0, -1), 0.0, 1.6),
    ("palpebrale_superius_left", (0, -1, 0), 0.2, 0.4), ("cheek_left", (-1, 0, -1), 0.35, 1.8),
    ("cheilion_left", (0, -1, 0), 0.3, 2.2), ("labiale_superius", (0, 0, -1), 0.2, 0.6),
    ("labiale_inferius", (0, 0, -1), 0.2, 0.6), (9, (1, 0, 0), 0.0, 2.4), (10, (1, 0, 0), 0.0, 3.0),
    (11, (1, -1, 0), 0.35, 3.3), (12, (1, -1, 0), 0.35, 3.3), ("pogonion", (0, 0, 1), 0.0, 2.0),
)  # fmt: skip


class Sex(Enum):
    """The sex whose norms a face is compared with."""

    WOMAN = "woman"
    MAN = "man"


@dataclass(frozen=True)
class Identity:
    """A face in numbers.

    sex, age [years]: that its weights were drawn for.
    hair: length relative to the cut's.
    cut: name of its cut (`CUTS` of hair.py).
    weights: of the modes, in deviations from the mean of people (space.py).
    unevenness: added to weights on the left side, and subtracted on the right side.
    covered: how much of the iris the upper lid covers [mm].
    corners: how far above the middle of the lips' line those of the mouth lie at rest [mm].
    brows: how far up the brows lie [mm].
    furrows: depth of furrows of age, relative to most people of that age.
    seen_lid: how much of the upper lid's skin is seen below its crease [mm]; below 0: none.
    hooding: how much less of it is seen at the outer corner [mm].
    smile: which muscles join in it.
    larynx: how far it stands out [mm].
    sternomastoid: how far it stands out beside the built-in head's, in a face of usual width [mm].
    lines: those of expression; None: the built-in head's.
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
    lines: Lines | None = None

    def scaled(self, share: float) -> Identity:
        """An identity with a share of its differences: 0 is the mean of people."""
        kinds = (self.weights, self.unevenness)
        weights, unevenness = (tuple(share * weight for weight in kind) for kind in kinds)
        return replace(self, weights=weights, unevenness=unevenness, brows=share * self.brows)


def norms_of(sex: Sex) -> dict[str, Sample]:
    """The norms of a sex, code -> sample."""
    return {code: norm.women if sex is Sex.WOMAN else norm.men for code, norm in NORMS.items()}


def scores_of(measures: Mapping[str, float], sex: Sex) -> dict[str, float]:
    """Deviations of measures on the surface [mm] from the means of a sex."""
    return {
        code: sample.score(measures[code] - PRESSED.get(code, 0.0))
        for code, sample in norms_of(sex).items()
    }


@dataclass(frozen=True)
class PersonSpace:
    """mean + weights @ modes [mm]."""

    mean: Floats64
    """Vertices, shape (V, 3)."""
    modes: Floats64
    """Shape (k, V, 3)."""
    slopes: Floats64
    """Changes of the measures of NORMS with each weight [mm], shape (m, k)."""
    pushed: Floats64
    """Changes of POINTS along their directions with each weight [mm], shape (n, k)."""
    anatomy: Mapping[str, int]

    def moved(self, weights: Floats64) -> Floats64:
        """Displacements from the mean, shape (V, 3)."""
        return np.asarray(np.tensordot(weights, self.modes, 1), dtype=np.float64)

    def draw(self, sex: Sex, age: float, random: np.random.Generator) -> Floats64:
        """Random weights for a sex and an age [years], shape (k,)."""
        chance = np.clip(random.normal(size=len(self.modes)), -MOST, MOST)
        near_norms = float(random.uniform())
        rows, beside, apart = self._measured(sex)
        unit = np.eye(len(self.modes))
        # These are higher: without this, noses stand too far forward, brows make them long, and the
        # skin above women's lips is as high as men's.
        firmness_of = MappingProxyType({"sn-prn": 6.0, "ft-ft": 1.5, "n-sn": 4.0, "sn-ls": 5.0})
        firmly = np.array([firmness_of.get(code, 1.0) for code in NORMS])[:, None]
        mean_firmness = 4.0  # weight of published means relative to the modes
        asked = mean_firmness * (firmly * rows).T
        held = unit + asked @ rows
        middle = np.linalg.solve(held, asked @ (near_norms * beside))
        decades = max(age - YOUNG, 0.0) / 10.0
        side = 1.0 if sex is Sex.MAN else -1.0
        far = np.array([decades * older + side * male for _, _, older, male in POINTS])
        # Changes of measures in ten years, in deviations.
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
        tolerance = 0.7  # [mm] in pushed points
        pushes = asked @ (apart + aged) + self.pushed.T @ far / tolerance**2
        own = np.linalg.solve(held + self.pushed.T @ self.pushed / tolerance**2, pushes)
        mean = middle + own
        # Deviations of the first mode (the size of the head), of the second to fourth, and of the
        # others.
        widths = {0: 0.6, 1: 1.1, 4: 1.2}
        width = np.interp(np.arange(len(unit)), list(widths), list(widths.values()))
        most_deviations = 4.0  # of any random weight
        return np.clip(mean + width * chance, -most_deviations, most_deviations)

    def _measured(self, sex: Sex) -> tuple[Floats64, Floats64, Floats64]:
        """The norms as equations for weights: rows (m, k), and right sides in deviations, (m,).

        The first right side leads from the mean of people to that of the norms of both sexes, the
        second one from there to those of a sex.
        """
        found = measures_of(self.mean, self.anatomy)
        norms = norms_of(sex)
        middles = np.array([0.5 * (norm.women.mean + norm.men.mean) for norm in NORMS.values()])
        surface = np.array([found[code] - PRESSED.get(code, 0.0) for code in NORMS])
        means = np.array([sample.mean for sample in norms.values()])
        deviations = np.array([sample.deviation for sample in norms.values()])
        rows = self.slopes / deviations[:, None]
        return rows, (middles - surface) / deviations, (means - middles) / deviations


@lru_cache(maxsize=1)
def person_space() -> PersonSpace:
    """The space whose middle is the mean of people, read from the data that ship."""
    head = load("head")
    arrays = read_arrays(head.beside("_modes.npz"))
    modes, own = (arrays[name].astype(np.float64) for name in ("modes", "weights"))
    mean = head.vertices - np.tensordot(own, modes, 1)
    sides = [
        [measures_of(mean + half * mode, head.anatomy) for half in (0.5, -0.5)] for mode in modes
    ]
    slopes = np.array([[more[code] - less[code] for more, less in sides] for code in NORMS])
    named = [point for point, *_ in POINTS]
    numbers = [head.landmarks[p] if isinstance(p, int) else head.anatomy[p] for p in named]
    ways = np.array([way for _, way, *_ in POINTS], dtype=np.float64)
    ways = unit_vectors(ways)
    corner = modes[:, head.anatomy["exocanthion_left"]] * [0.0, 1.0, 1.0]
    pushed = np.einsum("kni,ni->nk", modes[:, numbers] - corner[:, None], ways)
    return PersonSpace(mean, modes, slopes, pushed, head.anatomy)


def sample_identity(
    seed: int,
    *,
    sex: Sex | None = None,
    age: float | None = None,
    is_even: bool = False,
    population: Population = EVERYBODY,
) -> Identity:
    """The person with a number, always the same; even: left and right are alike.

    seed: 0 or more. sex, age: replace the number's own.
    """
    random = np.random.default_rng([seed, 17])
    drawn = Sex.WOMAN if random.random() < population.women else Sex.MAN
    sex = drawn if sex is None else sex
    years = float(random.uniform(*population.ages))
    age = years if age is None else age
    hair_lengths = 0.8, 1.2  # least and most factor on those of the cut
    hair = float(random.uniform(*hair_lengths))
    cuts = population.cuts_of_women if sex is Sex.WOMAN else population.cuts_of_men
    cut = str(random.choice(list(cuts), p=_normalised(cuts)))
    weights = person_space().draw(sex, age, random)
    sides = np.clip(random.normal(size=len(weights)), -MOST, MOST)
    unevenness = 0.1  # deviations of another person, added to the left side
    uneven = (0.0 if is_even else unevenness) * sides
    covered, corners, brows = np.clip(random.normal(size=3), -2.0, 2.0)
    furrows = float(np.clip(1.0 + 0.35 * random.normal(), 0.3, 1.7))
    late = max(age - YOUNG, 0.0) / 10.0
    is_woman = sex is Sex.WOMAN
    seen, hooded = np.clip(random.normal(size=2), -2.0, 2.0)
    spread = 1.0 + 0.06 * late
    return Identity(
        sex,
        age,
        hair,
        cut,
        tuple(weights.tolist()),
        tuple(uneven.tolist()),
        covered=float(np.clip(1.7 - 0.3 * is_woman + 0.6 * covered + 0.15 * late, 0.5, 3.0)),
        corners=float(0.7 + 0.3 * is_woman + 0.65 * corners - 0.08 * late),
        brows=float((1.0 if is_woman else 0.0) + 1.2 * brows - 0.2 * late),
        furrows=furrows,
        seen_lid=float(1.2 + 0.5 * is_woman + spread * seen),
        hooding=float(max(0.3 + 0.5 * hooded + 0.25 * late, 0.0)),
        smile=drawn_smile(is_woman, random),
        larynx=float(random.uniform(*((0.0, 0.8) if is_woman else (1.5, 5.0)))),
        lines=drawn_lines(not is_woman, age, random),
        sternomastoid=float(-0.35 + 0.25 * late + 0.4 * np.clip(random.normal(), -2.0, 2.0)),
    )


def _normalised(shares: Mapping[str, float]) -> Floats64:
    weights = np.array(list(shares.values()))
    return np.asarray(weights / weights.sum())
