"""What tells one person's face from another's: a sex, measures, and shapes beyond measures.

Measures are deviations from the published mean of a sex (`assets.norms`), drawn together, since
long faces have long noses. Two were left out of the draw, because others make them: the length of
an eye is what lies between inner and outer corners, the height of the upper lip is that of its skin
and its red.

How measures go together: the first thing in which faces differ is size, the second whether they
are long and narrow or short and wide (Zhuang, Slice, Benson, Lynch, Viscusi 2010, "Shape analysis
of 3D head scan data for U.S. respirator users", doi 10.1155/2010/248954, of 947 persons). Both are
factors here, and one more binds what neighbours share. How strong they are is chosen, but for two
pairs whose correlation follows from the published deviations: ex-ex = en-en + 2 en-ex (nearly)
gives 0.3 to 0.45 for ex-ex with en-en, sn-sto = sn-ls + ls-sto gives -0.2 for sn-ls with ls-sto.

Three widths were taken with calipers, which press on the skin over the bone (`norms`). A surface is
wider there: on three scanned persons the jaw is 1.3 times as wide as the outer eye corners are
apart, where the norms have 1.15. So as much as is pressed is added; how much is chosen by them.

The shapes beyond measures, and how far they go, are chosen by eye: no norm was found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

import numpy as np

from ..norms import NORMS, Sample

MOST = 2.5  # deviations from the mean
# Mean and deviation, by the norms' means, of how far the outer corner of an eye lies behind and
# above the inner one [mm], and of the straight way from nose to mouth, as a share of that over the
# border of the red.
EYE_DEPTH = 6.2, 0.8
LIP_BEND = 0.955, 0.008

PRESSED = {"go-go": 10.0, "zy-zy": 4.0, "ft-ft": 2.0}  # [mm] by calipers, both sides together


class Sex(Enum):
    """Whose norms a face is measured by."""

    WOMAN = "woman"
    MAN = "man"


@dataclass(frozen=True)
class Loading:
    """How much of a measure's deviation comes from what it shares with others.

    size: of the whole face. length: of long and narrow faces (+) or short and wide ones (-).
    group, share: the neighbours that it goes with, and how much. The squares' sum is below 1.
    """

    size: float
    length: float
    group: str = ""
    share: float = 0.0


LOADINGS: Mapping[str, Loading] = MappingProxyType(
    {
        "n-gn": Loading(0.50, 0.55, "lower face", 0.35),
        "n-sn": Loading(0.45, 0.40, "nose length", 0.70),
        "n-prn": Loading(0.45, 0.40, "nose length", 0.70),
        "sn-prn": Loading(0.30, 0.10),
        "sn-ls": Loading(0.25, 0.25, "red", -0.28),
        "ls-sto": Loading(0.15, -0.05, "red", 0.78),
        "sto-li": Loading(0.15, -0.05, "red", 0.78),
        "li-sl": Loading(0.25, 0.20, "lower face", 0.50),
        "en-en": Loading(0.35, -0.25, "eyes", -0.10),
        "ex-ex": Loading(0.50, -0.30, "eyes", 0.20),
        "al-al": Loading(0.35, -0.25, "mouth width", 0.25),
        "ch-ch": Loading(0.35, -0.10, "mouth width", 0.50),
        "cph-cph": Loading(0.20, -0.05, "mouth width", 0.30),
        "zy-zy": Loading(0.60, -0.40, "width", 0.30),
        "go-go": Loading(0.50, -0.30, "width", 0.30),
        "ft-ft": Loading(0.50, -0.30, "width", 0.30),
    }
)


@dataclass(frozen=True)
class Shape:
    """A shape beyond the measures: points of the left half or the middle, which go one way.

    pushes: name of an anatomical point, or number of a landmark, and the way it goes for one
        deviation [mm]; the right half mirrors it.
    """

    pushes: tuple[tuple[str | int, tuple[float, float, float]], ...]


SHAPES: Mapping[str, Shape] = MappingProxyType(
    {
        "nose bridge": Shape((("rhinion", (0.0, 0.0, 1.3)),)),
        "brow ridge": Shape((("glabella", (0, 0, 1.2)), (24, (0, 0, 1.2)), (25, (0, 0, 0.8)))),
        "forehead": Shape((("metopion", (0, 0, 1.2)), ("trichion", (0, 0, 3.0)))),
        "brow height": Shape(((22, (0, 1.3, 0)), (24, (0, 1.3, 0)), (26, (0, 1.0, 0)))),
        "brow tilt": Shape(((22, (0, -0.8, 0)), (26, (0, 1.2, 0)))),
        "eye slant": Shape(
            (("endocanthion_left", (0, -0.4, 0)), ("exocanthion_left", (0, 0.8, 0)))
        ),
        "eye opening": Shape(
            (("palpebrale_superius_left", (0, 0.5, 0)), ("palpebrale_inferius_left", (0, -0.2, 0)))
        ),
        "nose wings": Shape((("alare_left", (0, 0.8, 0)),)),
        "cheekbones": Shape((("zygion_left", (0, 1.5, 1.0)),)),
        "cheeks": Shape((("cheek_left", (1.0, 0, 1.7)), (12, (1.2, 0, 0.6)))),
        "jaw angle": Shape((("gonion_left", (0, 3.0, 1.0)),)),
        "chin": Shape((("pogonion", (0, 0, 2.2)), ("gnathion", (0, 0, 2.0)))),
        "chin width": Shape(((9, (2.5, 0, 0)), (10, (2.5, 0, 0)))),
        "jaw line": Shape(((11, (2.0, -1.5, 0)), (12, (1.5, -1.5, 0)))),
        "lips": Shape((("labiale_superius", (0, 0, 0.7)), ("labiale_inferius", (0, 0, 0.7)))),
        "mouth corners": Shape((("cheilion_left", (0, 0.7, 0)),)),
    }
)  # fmt: skip

# Where left and right differ, and by how much [mm]; points as of shapes.
UNEVEN: tuple[str | int, ...] = (
    "pronasale", "pogonion", "cheilion_left", "exocanthion_left", "zygion_left", "gonion_left",
    "alare_left", 24,
)  # fmt: skip
UNEVENNESS = 0.5


@dataclass(frozen=True)
class Identity:
    """A face in numbers.

    sex: whose norms `scores` belong to.
    scores: for each measure of `NORMS`, deviations from its mean.
    shapes: for each of `SHAPES`, deviations from the built-in head's.
    unevenness: how left and right differ: half of it at each of `UNEVEN` [mm], shape (8, 3); None
        for a face that is its own mirror image.
    """

    sex: Sex
    scores: Mapping[str, float]
    shapes: Mapping[str, float]
    unevenness: tuple[tuple[float, float, float], ...] | None = None

    @property
    def measures(self) -> dict[str, float]:
        """The measures that are asked for, on the surface of the face, code -> [mm]."""
        return {
            code: sample.mean + self.scores[code] * sample.deviation + PRESSED.get(code, 0.0)
            for code, sample in norms_of(self.sex).items()
        }

    def scaled(self, share: float) -> Identity:
        """An identity with a share of the deviations."""
        rows = self.unevenness
        return (
            self
            if share == 1.0
            else Identity(
                self.sex,
                {code: share * score for code, score in self.scores.items()},
                {name: share * score for name, score in self.shapes.items()},
                None
                if rows is None
                else tuple((share * x, share * y, share * z) for x, y, z in rows),
            )
        )


def norms_of(sex: Sex) -> dict[str, Sample]:
    """The norms of a sex, code -> sample."""
    return {code: norm.women if sex is Sex.WOMAN else norm.men for code, norm in NORMS.items()}


def sample_identity(seed: int, *, is_even: bool = False, spread: float = 1.0) -> Identity:
    """The person of a number: the same one every time, of either sex.

    is_even: left and right are alike. spread: 0 gives the mean of a sex, 1 the published
    deviations.
    """
    random = np.random.default_rng([seed, 17])
    sex = Sex.WOMAN if random.random() < 0.5 else Sex.MAN
    shared = {"size": random.normal(), "length": random.normal()}
    scores = {}
    for code, loading in LOADINGS.items():
        if loading.group not in shared:
            shared[loading.group] = random.normal()
        parts = np.array([loading.size, loading.length, loading.share])
        factors = np.array([shared["size"], shared["length"], shared[loading.group]])
        own = np.sqrt(1.0 - parts @ parts)
        scores[code] = spread * float(parts @ factors + own * random.normal())
    scores = {code: float(np.clip(score, -MOST, MOST)) for code, score in scores.items()}
    deeper, bend = np.clip(random.normal(size=2), -MOST, MOST)
    norms = norms_of(sex)
    value = {
        code: norms[code].mean + score * norms[code].deviation for code, score in scores.items()
    }
    depth = EYE_DEPTH[0] + EYE_DEPTH[1] * spread * deeper
    eye = float(np.hypot(0.5 * (value["ex-ex"] - value["en-en"]), depth))
    lip = (value["sn-ls"] + value["ls-sto"]) * (LIP_BEND[0] + LIP_BEND[1] * spread * bend)
    scores |= {"en-ex": norms["en-ex"].score(eye), "sn-sto": norms["sn-sto"].score(lip)}
    shapes = {name: spread * float(np.clip(random.normal(), -MOST, MOST)) for name in SHAPES}
    uneven = random.normal(0.0, UNEVENNESS * spread, (len(UNEVEN), 3))
    rows = None if is_even else tuple((float(x), float(y), float(z)) for x, y, z in uneven)
    return Identity(sex, scores, shapes, rows)
