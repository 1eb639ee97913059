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

from collections.abc import Iterable, Mapping
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


# Of each measure that is drawn: how much of its deviation is size, length (long and narrow faces
# against short and wide ones), and what it shares with neighbours. Their squares' sum is below 1.
LOADINGS: Mapping[str, tuple[float, float, str, float]] = MappingProxyType(
    {
        "n-gn": (0.50, 0.55, "lower face", 0.35),
        "n-sn": (0.45, 0.40, "nose length", 0.70),
        "n-prn": (0.45, 0.40, "nose length", 0.70),
        "sn-prn": (0.30, 0.10, "nose length", 0.0),
        "sn-ls": (0.25, 0.25, "red", -0.28),
        "ls-sto": (0.15, -0.05, "red", 0.78),
        "sto-li": (0.15, -0.05, "red", 0.78),
        "li-sl": (0.25, 0.20, "lower face", 0.50),
        "en-en": (0.35, -0.25, "eyes", -0.10),
        "ex-ex": (0.50, -0.30, "eyes", 0.20),
        "al-al": (0.35, -0.25, "mouth width", 0.25),
        "ch-ch": (0.35, -0.10, "mouth width", 0.50),
        "cph-cph": (0.20, -0.05, "mouth width", 0.30),
        "zy-zy": (0.60, -0.40, "width", 0.30),
        "go-go": (0.50, -0.30, "width", 0.30),
        "ft-ft": (0.50, -0.30, "width", 0.30),
    }
)

# Shapes beyond the measures: points of the left half or the middle (an anatomical name, or the
# number of a landmark), and the way each goes for one deviation [mm]; the right half mirrors it.
SHAPES: Mapping[str, tuple[tuple[str | int, tuple[float, float, float]], ...]] = MappingProxyType(
    {
        "nose bridge": (("rhinion", (0, 0, 1.3)),),
        "brow ridge": (("glabella", (0, 0, 1.2)), (24, (0, 0, 1.2)), (25, (0, 0, 0.8))),
        "forehead": (("metopion", (0, 0, 1.2)), ("trichion", (0, 0, 3.0))),
        "brow height": ((22, (0, 1.3, 0)), (24, (0, 1.3, 0)), (26, (0, 1.0, 0))),
        "brow tilt": ((22, (0, -0.8, 0)), (26, (0, 1.2, 0))),
        "eye slant": (("endocanthion_left", (0, -0.4, 0)), ("exocanthion_left", (0, 0.8, 0))),
        "eye opening": (
            ("palpebrale_superius_left", (0, 0.5, 0)), ("palpebrale_inferius_left", (0, -0.2, 0)),
        ),
        "nose wings": (("alare_left", (0, 0.8, 0)),),
        "cheekbones": (("zygion_left", (0, 1.5, 1.0)),),
        "cheeks": (("cheek_left", (1.0, 0, 1.7)), (12, (1.2, 0, 0.6))),
        "jaw angle": (("gonion_left", (0, 3.0, 1.0)),),
        "chin": (("pogonion", (0, 0, 2.2)), ("gnathion", (0, 0, 2.0))),
        "chin width": ((9, (2.5, 0, 0)), (10, (2.5, 0, 0))),
        "jaw line": ((11, (2.0, -1.5, 0)), (12, (1.5, -1.5, 0))),
        "lips": (("labiale_superius", (0, 0, 0.7)), ("labiale_inferius", (0, 0, 0.7))),
        "mouth corners": (("cheilion_left", (0, 0.7, 0)),),
    }
)  # fmt: skip
# By how many deviations men differ, and women the other way; and what ten years beyond 30 do.
# Chosen after what anatomists name: brow ridge, jaw and chin of men; skin that sags with age.
OF_MEN: Mapping[str, float] = MappingProxyType(
    {
        "nose bridge": 0.7, "brow ridge": 1.0, "forehead": -0.5, "brow height": -0.7,
        "brow tilt": -0.3, "eye opening": -0.7, "cheekbones": -0.4, "cheeks": -0.3,
        "chin width": 0.8, "jaw line": 0.6, "lips": -0.6, "nose wings": -0.3,
    }
)  # fmt: skip
OF_AGE: Mapping[str, float] = MappingProxyType(
    {
        "brow height": -0.25, "eye opening": -0.4, "cheeks": -0.35, "jaw line": 0.35,
        "lips": -0.35, "mouth corners": -0.4,
    }
)  # fmt: skip
HAIR = 0.75, 1.3  # how long it is, beside its cut
CUT_SHARES: Mapping[Sex, Mapping[str, float]] = MappingProxyType(
    {
        Sex.WOMAN: {"fringed": 0.5, "swept": 0.2, "curly": 0.2, "brushed": 0.1},
        Sex.MAN: {"short": 0.4, "cropped": 0.25, "brushed": 0.15, "swept": 0.1, "curly": 0.1},
    }
)
AGES = 20.0, 75.0  # [years]
UNEVENNESS = 0.08  # of a shape's deviation, by which it is more on the left and less on the right


@dataclass(frozen=True)
class Identity:
    """A face in numbers.

    sex: whose norms `scores` belong to.
    age: [years].
    hair: how long it is, beside that of its cut.
    cut: name of its cut (`CUTS` of hair.py).
    scores: for each measure of `NORMS`, deviations from its mean.
    shapes: for each of `SHAPES`, deviations from the built-in head's.
    unevenness: for each of `SHAPES`, by how much it is more on the left and less on the right.
    """

    sex: Sex
    age: float
    hair: float
    cut: str
    scores: Mapping[str, float]
    shapes: Mapping[str, float]
    unevenness: Mapping[str, float]

    @property
    def measures(self) -> dict[str, float]:
        """The measures that are asked for, on the surface of the face, code -> [mm]."""
        return {
            code: sample.mean + self.scores[code] * sample.deviation + PRESSED.get(code, 0.0)
            for code, sample in norms_of(self.sex).items()
        }

    def scaled(self, share: float) -> Identity:
        """An identity with a share of all deviations: 0 is the mean of its sex."""
        kinds = (self.scores, self.shapes, self.unevenness)
        return Identity(
            self.sex,
            self.age,
            self.hair,
            self.cut,
            *({key: share * kind[key] for key in kind} for kind in kinds),
        )


def norms_of(sex: Sex) -> dict[str, Sample]:
    """The norms of a sex, code -> sample."""
    return {code: norm.women if sex is Sex.WOMAN else norm.men for code, norm in NORMS.items()}


def sample_identity(
    seed: int, *, sex: Sex | None = None, age: float | None = None, is_even: bool = False
) -> Identity:
    """The person of a number: the same one every time; even: left and right alike.

    seed: 0 and more. sex, age: instead of the number's own.
    """
    random = np.random.default_rng([seed, 17])

    def bounded(names: Iterable[str]) -> dict[str, float]:
        """Independent deviations, none too large."""
        return {name: float(np.clip(random.normal(), -MOST, MOST)) for name in names}

    drawn = Sex.WOMAN if random.random() < 0.5 else Sex.MAN
    sex = drawn if sex is None else sex
    norms = norms_of(sex)
    size, length = random.normal(size=2)
    groups = {group: random.normal() for _, _, group, _ in LOADINGS.values()}
    scores, value = {}, {}
    for code, (large, long, group, share) in LOADINGS.items():
        rest = np.sqrt(1.0 - large**2 - long**2 - share**2)
        score = large * size + long * length + share * groups[group] + rest * random.normal()
        scores[code] = float(np.clip(score, -MOST, MOST))
        value[code] = norms[code].mean + scores[code] * norms[code].deviation
    own = bounded(("eye", "lip"))
    depth = EYE_DEPTH[0] + EYE_DEPTH[1] * own["eye"]
    eye = float(np.hypot(0.5 * (value["ex-ex"] - value["en-en"]), depth))
    lip = (value["sn-ls"] + value["ls-sto"]) * (LIP_BEND[0] + LIP_BEND[1] * own["lip"])
    scores |= {"en-ex": norms["en-ex"].score(eye), "sn-sto": norms["sn-sto"].score(lip)}
    shapes, sides = bounded(SHAPES), bounded(SHAPES)
    share = 0.0 if is_even else UNEVENNESS
    years = float(random.uniform(*AGES))
    age = years if age is None else age
    side, decades = (1.0 if sex is Sex.MAN else -1.0), max(age - 30.0, 0.0) / 10.0
    for name in shapes:
        shift = side * OF_MEN.get(name, 0.0) + decades * OF_AGE.get(name, 0.0)
        shapes[name] = float(np.clip(0.8 * shapes[name] + shift, -MOST, MOST))
    hair = float(random.uniform(*HAIR))
    cuts = CUT_SHARES[sex]
    cut = str(random.choice(list(cuts), p=list(cuts.values())))
    return Identity(
        sex, age, hair, cut, scores, shapes, {name: share * sides[name] for name in SHAPES}
    )
