"""What benchmarks are held to: each target says so, and a missed one ends with exit code 1."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner

from risorius.bench.refinement import commands as refinement
from risorius.bench.refinement import quality, quality_report
from risorius.bench.refinement.quality import Score
from risorius.bench.report import at_least, at_most
from risorius.bench.scans import commands as scans
from risorius.bench.scans import motion
from risorius.bench.simulation import commands as simulation
from risorius.bench.simulation import gaps, soak, tearing
from risorius.bench.simulation.gaps import PoseGaps
from risorius.bench.simulation.soak import Soak
from risorius.bench.simulation.tearing import PoseDefects

SOUND = Soak(60.0, 3600, True, 94.0, 0.0, 0.0, True, 1e-12)
CLOSED = PoseGaps("blink", 0.1, 0.0, 0.2)
WHOLE = PoseDefects("joy", 0, 0.01, 0.0, 0.0)
ALIKE = motion.Row("joy", 0.96, 1.0, 0.1, 0.5, 0.8, 0.7)
KEYS = (
    quality_report.STATIC_KEY,
    ("cubic", "displacement", 2.0),
    ("cubic", "displacement, blended", 2.0),
)
NEARER = [Score(key, "joy", 2030, *each, 9.0, 1.1) for key, each in zip(
    KEYS, ((1.0, 9.0, 10.0), (0.6, 6.0, 6.0), (0.8, 7.0, 7.0)), strict=True)]  # fmt: skip


def run(
    command: click.Command, measured: dict[tuple[Any, str], Any], *words: str
) -> tuple[int, str]:
    """Exit code and output of a benchmark that measured this."""
    with pytest.MonkeyPatch.context() as patch:
        for (module, name), value in measured.items():
            patch.setattr(module, name, lambda *_, value=value, **__: value)
        ended = CliRunner().invoke(command, words)
    return ended.exit_code, ended.output


def of_soak(**change: Any) -> tuple[int, str]:
    return run(simulation.bench_soak, {(soak, "measure"): replace(SOUND, **change)})


def of_gaps(**change: Any) -> tuple[int, str]:
    return run(simulation.bench_gaps, {(gaps, "measure"): [CLOSED, replace(CLOSED, **change)]})


def of_tearing(**change: Any) -> tuple[int, str]:
    poses = [*[WHOLE] * 99, replace(WHOLE, **change)]
    return run(simulation.bench_tearing, {(tearing, "measure"): poses})


def of_motion(**change: Any) -> tuple[int, str]:
    rows = [*[ALIKE] * 9, replace(ALIKE, **change)]
    return run(
        scans.bench_motion, {(motion, "measure"): (rows, [], {"ada": rows})}, "--reference", "."
    )


def of_quality(**change: Any) -> tuple[int, str]:
    subject = type("Subject", (), {"group": "head", "coarse_faces": [], "dense_faces": []})
    scores = [NEARER[0], *(replace(each, **change) for each in NEARER[1:])]
    measured = {(refinement, "_subjects"): [subject], (quality, "measure"): scores}
    return run(refinement.bench_quality, measured)


@pytest.mark.parametrize(
    ("bench", "broken"),
    [
        (of_soak, {"finite": False}),
        (of_soak, {"furthest": 500.0}),
        (of_soak, {"rest_error": 0.1}),
        (of_soak, {"growth": 1e-3}),
        (of_soak, {"same_bytes": False}),
        (of_soak, {"mirror_error": float("nan")}),
        (of_gaps, {"lips": 0.3}),
        (of_gaps, {"lids": 0.3}),
        (of_tearing, {"inverted": 4}),
        (of_tearing, {"teeth": 0.2}),
        (of_motion, {"cosine": 0.87}),
        (of_motion, {"cosine": 0.1}),
        (of_quality, {"distance": 0.9}),
        (of_quality, {"picture": 9.9}),
        (of_quality, {"jump": 1.6}),
    ],
)  # fmt: skip
def test_a_missed_target_is_told_and_ends_with_one(
    bench: Callable[..., tuple[int, str]], broken: dict[str, Any]
) -> None:
    """All that is as it should be ends with 0, and says "met" for each target."""
    code, told = bench()
    assert code == 0 and "  met     " in told and "MISSED" not in told
    code, told = bench(**broken)
    assert code == 1 and "  MISSED  " in told


def test_what_is_no_number_meets_nothing() -> None:
    """Neither an upper nor a lower bound."""
    assert not at_most("x", float("nan"), 1.0).is_met
    assert not at_least("x", float("nan"), 1.0).is_met


def test_figures_are_written_though_a_target_is_missed(tmp_path: Path) -> None:
    """A program that reads them wants these most."""
    file = tmp_path / "gaps.json"
    measured = {(gaps, "measure"): [replace(CLOSED, lips=3.0)]}
    assert run(simulation.bench_gaps, measured, "--json", str(file))[0] == 1 and file.exists()
