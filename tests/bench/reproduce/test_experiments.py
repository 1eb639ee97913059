"""A verdict can be bad, and `reproduce all` writes its page and pictures with any verdict."""

import math
import re
import sys
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

from risorius.bench.reproduce import commands
from risorius.bench.reproduce.experiments import (
    EXPERIMENTS,
    Claim,
    Experiment,
    Outcome,
)
from risorius.bench.reproduce.table1 import TableRow
from tests.app.command_line import risorius


def test_pairs_are_compared_round_by_round():
    """The ratio c_rt does not change when the machine becomes ten times slower meanwhile."""
    times = np.array([[1.0, 3.0]] * 5 + [[10.0, 30.0]] * 6)
    row = TableRow.from_seconds("", 100, 200, times)
    assert (row.ratio, row.quartiles) == (1.5, (1.5, 1.5))


@pytest.mark.parametrize(
    ("value", "differs", "verdict"),
    [
        (2.0, "", "met"),
        (2.0, "it approximates", "differs"),  # the bounds are this project's, not the paper's
        (0.9, "", "MISSED"),
        (3.1, "it approximates", "MISSED"),
        (math.nan, "", "MISSED"),
    ],
)
def test_verdicts(value, differs, verdict):
    """A verdict checks the lower and the upper bound; NaN is outside."""
    claim = Claim("x", "", "", low=1.0, high=3.0, differs=differs)
    assert claim.verdict(value) == verdict


def test_every_claim_can_fail():
    """Each claim has a bound, and its name is unique within its experiment."""
    for experiment in EXPERIMENTS:
        names = [each.value for each in experiment.claims]
        assert len(set(names)) == len(names)
        for each in experiment.claims:
            assert each.low > -math.inf or each.high < math.inf, each.value


OUTCOMES = {
    "good": lambda: Outcome({"lines": 0}, np.full((8, 8, 3), 200, np.uint8)),
    "bad": lambda: Outcome({"<c_rt>": 3.0}),
}
PLANTED_EXPERIMENTS = (
    Experiment(
        *("good", "Good & sound", "section 1", "planted.good"),
        claims=[Claim("lines", "no line turns", "none", 0.0, 0.0)],
        picture=True,
    ),
    Experiment(
        *("bad", "Bad", "section 2", "planted.bad"),
        claims=[Claim("<c_rt>", "not too slow", "1.75", high=1.75, style=".2f")],
    ),
)


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two experiments that take no time: the first meets its claim, the second misses its claim."""
    monkeypatch.setitem(sys.modules, f"{commands.__package__}.planted", SimpleNamespace(**OUTCOMES))
    monkeypatch.setattr(commands, "EXPERIMENTS", PLANTED_EXPERIMENTS)


def test_a_missed_tolerance_is_reported_after_all_is_written(planted, tmp_path):
    """After a missed tolerance, all files are written and the exit code is 1.

    Each miss has a line.
    """
    result = risorius("reproduce", "all", "-o", tmp_path / "new")
    assert result.exit_code == 1
    missed = [line for line in result.stderr.splitlines() if line.startswith("risorius: ")]
    assert missed == ["risorius: MISSED: <c_rt> is 3.00, allowed: at most 1.75"]
    names = {path.name for path in (tmp_path / "new").iterdir()}
    assert names == {"index.html", "good.png"}


def test_the_page_stands_alone(planted, tmp_path):
    """The page loads only pictures beside it, escapes its text, and shows every verdict."""
    risorius("reproduce", "all", "-o", tmp_path)
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert re.findall(r"(?:src|href)=\"([^\"]*)\"", text) == ["good.png"]
    assert "url(" not in text
    assert "@import" not in text
    assert "<c_rt>" not in text
    assert "&lt;c_rt&gt;" in text
    assert "Good &amp; sound" in text
    assert "1 of 2 statements" in text
    for words in ("met ", "MISSED ", "not too slow", "3.00"):
        assert words in text
    assert text.index("section 1") < text.index("section 2")


def test_every_experiment_can_be_named():
    """The help of `reproduce` lists each experiment, and each entry names an existing function."""
    help_text = risorius("reproduce", "--help").output
    for experiment in EXPERIMENTS:
        module, name = experiment.function.split(".")
        code = import_module(f"{commands.__package__}.{module}")
        assert experiment.name in help_text
        assert callable(getattr(code, name))
