"""Verdicts can be bad; `reproduce all` writes page and pictures, whatever they say."""

import math
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from risorius.app.refining.presets import PAPERS_PRESET, PRESETS
from risorius.app.scenes import PlaneScene
from risorius.assets.sheets import CELL, COLUMNS, ROWS
from risorius.bench.reproduce import commands
from risorius.bench.reproduce.experiments import (
    EXPERIMENTS,
    INFERRED,
    Claim,
    Experiment,
    Measured,
    Outcome,
    Verdict,
)
from risorius.bench.reproduce.table1 import WAYS, Row
from risorius.refine.kahler import criterion, smoothing
from risorius.refine.mesh import rings
from tests.app.command_line import risorius


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
    ours = Claim("x", "", "less", low=0.9, high=1.1, differs=True)
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


def test_what_was_inferred_is_what_runs() -> None:
    """Weights, thresholds and the plane, as the page tells them, are those of the program."""

    def share(*weights: float) -> str:
        return ", ".join(str(Fraction(float(each)).limit_denominator(64)) for each in weights)

    plane = PRESETS[PAPERS_PRESET]["plane"].told("kahler")
    assert {
        f"{criterion.THRESHOLD_ONCE:g}, {criterion.THRESHOLD_TWICE:g}",
        f"{plane['threshold_once']:g}, {plane['threshold_twice']:g}",
        f"{criterion.ROUNDING:g}",
        share(smoothing.EDGE_END, smoothing.EDGE_WING),
        share(smoothing.BORDER_EDGE_END),
        share(rings.BORDER_OWN, rings.BORDER_RING),
        share(smoothing.MIDDLE_OWN, smoothing.MIDDLE_RING),
        f"{COLUMNS} x {ROWS} cells of {CELL:g} mm, {PlaneScene.WAVES:g} waves, "
        f"{PlaneScene.HEIGHT:g} of its length high",
    } < {each["value"] for each in INFERRED}


MADE: dict[str, Outcome] = {
    "good": Outcome({"lines": 0}, np.full((8, 8, 3), 200, np.uint8)),
    "bad": Outcome({"<c_rt>": Measured(3.0, (2.9, 3.1)), "time": Measured(0.4, least=0.5)}),
}
PLANTED = (
    Experiment(
        *("good", "Good & sound", "section 1", "Be good.", "planted.good"),
        claims=[Claim("lines", "no line turns", "none", 0.0, 0.0)],
        picture=True,
    ),
    Experiment(
        *("bad", "Bad", "section 2", "Be bad.", "planted.bad"),
        claims=[
            Claim("<c_rt>", "not too slow", "1.75", high=1.75, style=".2f"),
            Claim("time", "not too fast", "", high=9.0),
        ],
    ),
)


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two experiments that take no time: one is met, one is missed and noise."""

    monkeypatch.setattr(Experiment, "callable", property(lambda each: lambda: MADE[each.name]))
    monkeypatch.setattr(commands, "EXPERIMENTS", PLANTED)


def test_a_missed_tolerance_is_told_after_all_is_written(planted: None, tmp_path: Path) -> None:
    """Exit code 1, a line for each that is missed, and every file is there."""
    result = risorius("reproduce", "all", "-o", tmp_path / "new")
    assert result.exit_code == 1
    missed = [line for line in result.stderr.splitlines() if line.startswith("risorius: ")]
    assert missed == [
        "risorius: MISSED: <c_rt> is 3.00 (2.90 to 3.10), allowed: at most 1.75",
        "risorius: noise: time is 0.4, allowed: at most 9; possible from 0.5",
    ]
    names = {path.name for path in (tmp_path / "new").iterdir()}
    assert names == {"index.html", "good.png"}


def test_the_page_stands_alone(planted: None, tmp_path: Path) -> None:
    """It loads nothing but pictures beside it, escapes what it says, and shows every verdict."""
    risorius("reproduce", "all", "-o", tmp_path)
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert re.findall(r"(?:src|href)=\"([^\"]*)\"", text) == ["good.png"]
    assert "url(" not in text and "@import" not in text
    assert "<c_rt>" not in text and "&lt;c_rt&gt;" in text and "Good &amp; sound" in text
    assert "1 of 3 statements" in text and "0.02, 0.08" in text
    for words in ("met ", "MISSED ", "noise ", "not too slow", "3.00 (2.90 to 3.10)"):
        assert words in text
    assert text.index("section 1") < text.index("section 2") < text.index("does not give")


def test_every_experiment_can_be_named() -> None:
    """The command knows it, and its entry names a function that is there."""
    told = risorius("reproduce", "--help").output
    for experiment in EXPERIMENTS:
        assert experiment.name in told and callable(experiment.callable)
