"""Compare the differences between women and men in our persons with published ones.

Every person's number is drawn twice, as a woman and as a man, so that both have equal random
values. A caliper presses the skin, so this depth is subtracted from our widths before they are
compared with published ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from risorius.assets.identities import sample_identity
from risorius.assets.identities.space import PRESSED_DEPTHS, Sex, person_space
from risorius.assets.norms import NORMS, measures_of

from .report import Target, at_most, table


@dataclass(frozen=True)
class PersonsRow:
    """One measure of NORMS: means of our women and men, and published means [mm]."""

    code: str
    women: float
    men: float
    published_women: float
    published_men: float
    deviation: float
    """Published deviation of women."""

    @property
    def difference(self) -> float:
        """Mean of men minus mean of women [mm]."""
        return self.men - self.women

    @property
    def published_difference(self) -> float:
        """Published mean of men minus published mean of women [mm]."""
        return self.published_men - self.published_women


def measure(count: int) -> list[PersonsRow]:
    """Draw `count` women and as many men, and measure them."""
    space = person_space()
    means = {}
    for sex in Sex:
        drawn = [sample_identity(number, sex=sex) for number in range(1000, 1000 + count)]
        faces = [space.mean + space.moved(np.array(identity.weights)) for identity in drawn]
        found = [measures_of(face, space.anatomy) for face in faces]
        means[sex] = {code: float(np.mean([each[code] for each in found])) for code in NORMS}
    rows = []
    for code, norm in NORMS.items():
        pressed = PRESSED_DEPTHS.get(code, 0.0)
        women = means[Sex.WOMAN][code] - pressed
        men = means[Sex.MAN][code] - pressed
        published = norm.women.mean, norm.men.mean
        rows.append(PersonsRow(code, women, men, *published, norm.women.deviation))
    return rows


def report(rows: list[PersonsRow]) -> str:
    """The text to print."""
    columns = (
        "measure:<8|women:6.1f|published:9.1f|men:6.1f|published:9.1f|men's more:10.1f|"
        "published:9.1f"
    )
    cells = []
    for row in rows:
        women = row.women, row.published_women
        men = row.men, row.published_men
        cells.append((row.code, *women, *men, row.difference, row.published_difference))
    return "\n".join(["means [mm]", *table(columns, cells)])


def targets(rows: list[PersonsRow]) -> list[Target]:
    """The targets: differences between the sexes are near the published ones."""
    off = np.mean([abs(row.difference - row.published_difference) / row.deviation for row in rows])
    return [at_most("sexes off the published distance, in deviations", float(off), 0.4)]
