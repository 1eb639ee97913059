"""`risorius reproduce all` writes a page, pictures and figures, whatever they say."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from risorius.__main__ import command
from risorius.bench.reproduce import experiments, reproduction
from risorius.bench.reproduce.claims import Claim, Measured, Outcome
from risorius.bench.reproduce.experiments import EXPERIMENTS, Experiment

MADE: dict[str, Outcome] = {
    "good": Outcome({"lines": 0}, {"good": np.full((8, 8, 3), 200, np.uint8)}, renderer="softpipe"),
    "bad": Outcome({"<c_rt>": Measured(3.0, (2.9, 3.1)), "time": Measured(0.4, least=0.5)}),
}
PLANTED = (
    Experiment(
        *("good", "Good & sound", "section 1", "Be good.", "planted.good"),
        claims=(Claim("lines", "no line turns", "none", 0.0, 0.0),),
        has_picture=True,
    ),
    Experiment(
        *("bad", "Bad", "section 2", "Be bad.", "planted.bad"),
        claims=(
            Claim("<c_rt>", "not too slow", "1.75", high=1.75, style=".2f"),
            Claim("time", "not too fast", "", high=9.0),
        ),
    ),
)


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two experiments that take no time: one is met, one is missed and noise."""

    def run(self: Experiment, **_: Any) -> experiments.Result:
        return experiments.Result(self, MADE[self.name])

    monkeypatch.setattr(Experiment, "run", run)
    monkeypatch.setattr(reproduction, "EXPERIMENTS", PLANTED)


def risorius(*arguments: str | Path) -> Result:
    """Run the command in this process."""
    return CliRunner().invoke(command(), list(map(str, arguments)))


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
    assert names == {"index.html", "results.json", "good.png"}


def test_all_met_ends_well(planted: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit code 0."""
    monkeypatch.setattr(reproduction, "EXPERIMENTS", PLANTED[:1])
    assert risorius("reproduce", "all", "-o", tmp_path).exit_code == 0


def test_figures_for_programs(planted: None, tmp_path: Path) -> None:
    """Numbers, tolerances, verdicts, what was inferred, and where it was made."""
    risorius("reproduce", "all", "-o", tmp_path)
    figures = json.loads((tmp_path / "results.json").read_text())
    good, bad = figures["experiments"]
    assert figures["missed"] == 2 and figures["opengl"] == "softpipe"
    assert good["pictures"] == ["good.png"] and good["claims"][0]["verdict"] == "met"
    assert bad["claims"][0]["quartiles"] == [2.9, 3.1]
    assert [each["verdict"] for each in bad["claims"]] == ["MISSED", "noise"]
    assert "0.02, 0.08" in [each["value"] for each in figures["inferred"]]
    assert {"version", "date", "processor", "system", "paper"} < set(figures)


class Page(HTMLParser):
    """What a browser would load, and tags that are never closed."""

    def __init__(self) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Note it."""
        self.loads += [value or "" for name, value in attributes if name in ("src", "href")]
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """The last one that is open."""
        assert self.open.pop() == tag


def test_the_page_stands_alone(planted: None, tmp_path: Path) -> None:
    """It loads nothing but pictures beside it, escapes what it says, and shows every verdict."""
    risorius("reproduce", "all", "-o", tmp_path)
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    page = Page()
    page.feed(text)
    assert not page.open
    assert set(page.loads) == {"#good", "#bad", "good.png"}
    assert "url(" not in text and "@import" not in text
    assert "&lt;c_rt&gt;" in text and "Good &amp; sound" in text
    assert "<b>1</b> of 3 statements" in text
    for words in ('class="met">met', 'class="missed">MISSED', 'class="noise">noise', "softpipe"):
        assert words in text
    assert text.index("section 1") < text.index("section 2") < text.index("does not give")
    assert re.search(r"width=device-width", text)


@pytest.mark.parametrize("experiment", EXPERIMENTS, ids=lambda each: each.name)
def test_every_experiment_is_a_command(experiment: Experiment) -> None:
    """It has help, and the function that its entry names."""
    result = risorius("reproduce", experiment.name, "--help")
    assert result.exit_code == 0
    assert ("--output" in result.output) == experiment.has_picture
    assert ("--rounds" in result.output) == (experiment.rounds is not None)
    assert callable(experiment.callable)


@pytest.mark.slow
def test_frame_rate() -> None:
    """Every number of the statement is measured; whether it is met is the machine's affair."""
    (experiment,) = (each for each in EXPERIMENTS if each.name == "frame-rate")
    for finding in experiment.run(rounds=4).findings:
        assert np.isfinite(finding.measured.value), finding.claim.value
