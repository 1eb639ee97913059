"""Verdicts can be bad: planted measurements are missed, or called noise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from risorius.bench.reproduce.claims import Claim, Finding, Measured, Verdict
from risorius.bench.reproduce.experiments import EXPERIMENTS
from risorius.bench.reproduce.table1 import WAYS, Row


def claim(name: str) -> Claim:
    """The claim about a value of the table."""
    (found,) = (
        each for experiment in EXPERIMENTS for each in experiment.claims if each.value == name
    )
    return found


def judged(refined: float, static: float = 1.0, *, noise: float = 0.0) -> Verdict:
    """The verdict on times of the plane [ms], with noise that is alike in each round."""
    rounds = np.array([[static, refined]] * 9) * 1e-3
    rounds *= 1.0 + noise * np.linspace(-1.0, 1.0, 9)[:, None]
    name = f"plane, {WAYS[-1]}"
    return claim(name).judge(Row.of(name, 154, 1328, rounds).ratio)


def test_a_refined_mesh_cannot_be_faster() -> None:
    """More triangles in less time are noise, however good c_rt looks; in more time they are not."""
    assert judged(0.99) is Verdict.NOISE
    assert judged(0.4, noise=0.5) is Verdict.NOISE
    assert judged(1.01) is Verdict.MET


def test_what_costs_more_than_in_the_paper_is_missed() -> None:
    """2.58 times the ratio of the triangles, 1328 / 154, is allowed."""
    assert judged(22.2) is Verdict.MET
    assert judged(22.3) is Verdict.MISSED


def test_pairs_are_compared_round_by_round() -> None:
    """A machine that becomes ten times slower on the way does not change c_rt."""
    times = np.array([[1.0, 3.0]] * 5 + [[10.0, 30.0]] * 6)
    row = Row.of("", 100, 200, times)
    assert row.ratio == Measured(1.5, (1.5, 1.5), 0.5)


@pytest.mark.parametrize(
    ("value", "verdict"),
    [(2.0, Verdict.MET), (0.9, Verdict.MISSED), (3.1, Verdict.MISSED), (math.nan, Verdict.MISSED)],
)
def test_verdicts(value: float, verdict: Verdict) -> None:
    """Both bounds count, and what is no number is missed."""
    assert Claim("x", "", "", low=1.0, high=3.0).judge(Measured(value)) is verdict


def test_what_is_known_to_differ_is_not_called_met() -> None:
    """Where bounds are ours and not the paper's the verdict says so; beyond them it is missed."""
    ours = Claim("x", "", "less", low=0.9, high=1.1, is_met=False)
    assert ours.judge(Measured(1.04)) is Verdict.DIFFERS
    assert ours.judge(Measured(1.2)) is Verdict.MISSED
    assert claim("Gouraud: shading error, refined over static").judge(Measured(1.04)) is (
        Verdict.DIFFERS
    )


def test_every_claim_can_fail() -> None:
    """Each has a bound and a name of its own within its experiment."""
    for experiment in EXPERIMENTS:
        names = [each.value for each in experiment.claims]
        assert len(set(names)) == len(names)
        for each in experiment.claims:
            assert each.low > -math.inf or each.high < math.inf, each.value


def test_numbers_are_told_with_their_spread() -> None:
    """The median, and the quartiles where there are any."""
    measured = Measured.median(np.arange(5.0))
    assert Finding(Claim("x", "", "", high=3.0, style=".1f"), measured).ours == "2.0 (1.0 to 3.0)"
    assert Finding(Claim("x", "", "", low=27, high=27), Measured(27)).ours == "27"
    assert Claim("x", "", "", low=27, high=27).tolerance == "exactly 27"
    assert Claim("x", "", "", low=1, high=2).tolerance == "at least 1, at most 2"
