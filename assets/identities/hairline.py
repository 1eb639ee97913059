"""Hairlines of persons: where hair begins on the forehead and the crown, by sex and age."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats32
from ...geometry.steps import smoothstep

NO_RECESSION_AGE = 25.0  # [years] up to which no hairline has receded


@dataclass(frozen=True)
class Hairline:
    """A person's hairline, compared with the built-in head's.

    front: distance behind the built-in hairline at the midline [mm].
    temples: further distance at the corners of the forehead [mm].
    crown: baldness of the crown, 0 to 1.
    tied: distance by which hair that is tied back is dense farther in front [mm].
    """

    front: float = 0.0
    temples: float = 0.0
    crown: float = 0.0
    tied: float = 0.0

    def shift(self, size: int, rows: slice = slice(None)) -> Floats32:
        """Compute distances behind the built-in hairline [mm], for `rows` of a (size, size) map."""
        across = np.linspace(-0.5, 0.5, size)
        up = np.linspace(1.0, 0.0, size)
        row = self.front * np.exp(-((across / 0.17) ** 4))
        row += self.temples * np.exp(-(((np.abs(across) - 0.12) / 0.05) ** 2))
        # Real hairlines are uneven, so each person's has other notches and tongues.
        turn = self.front + self.temples
        row += 1.3 * np.sin(107.0 * across + turn) + 1.1 * np.sin(241.0 * across + 3.0 * turn)
        ahead = 1.0 - smoothstep(up, 0.74, 0.82)
        bald_depth = 40.0  # [mm] that a wholly bald crown shifts the hairline
        beside = self.crown * bald_depth * np.exp(-((across / 0.14) ** 2))
        top = np.exp(-(((up - 0.78) / 0.15) ** 2))
        ahead, row, top, beside = np.array([ahead, row, top, beside], dtype=np.float32)
        whole = np.multiply.outer(ahead[rows], row)
        whole += np.multiply.outer(top[rows], beside)
        if self.tied:
            # At the crown and on sideburns hair is dense, or has its place.
            before = 1.0 - smoothstep(up[rows], 0.8, 0.95)
            within = np.exp(-((across / 0.25) ** 4))
            whole -= np.multiply.outer(self.tied * before, within).astype(np.float32)
        return np.asarray(whole, np.float32)


def drawn_hairline(is_man: bool, years: float, random: np.random.Generator) -> Hairline:
    """Choose a random hairline for a person of this sex and age [years].

    Straight, round and M-shaped hairlines are as frequent as among 456 persons: 43, 39 and 18 % of
    women, 46, 11 and 43 % of men. The hairline of men lies 4.5 mm higher. Source: Kashiyama and
    others 2021, "Hairline morphology", Plast. Reconstr. Surg. Glob. Open 9:e3765. How much the
    hairline recedes with age is chosen by eye.
    """
    kind, _, share, bald = random.uniform(0.0, 1.0, 4)
    front = float(np.clip(random.normal(0.0, 3.0), -6.0, 6.0))
    straight, round_ = (0.46, 0.57) if is_man else (0.43, 0.82)
    if kind < straight:
        temples = 0.0
    elif kind < round_:
        temples = -5.0
    else:
        temples = 6.0 + 6.0 * share
    late = max(years - NO_RECESSION_AGE, 0.0) / 50.0
    receded = 22.0 * late * share**0.7 if is_man else 3.0 * late
    return Hairline(
        front=(0.5 if is_man else -2.0) + front + 0.6 * receded,
        temples=temples + (receded if is_man else 0.0),
        crown=float(is_man and bald < 0.5 * late),
    )
