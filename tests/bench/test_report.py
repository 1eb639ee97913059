"""Reports and targets of benchmarks: a missed target gives exit code 1."""

import pytest
from click.testing import CliRunner

from risorius.bench import commands, gaps, motion, quality, subjects
from risorius.bench.gaps import MeasuredPose
from risorius.bench.quality import BEST_METHOD, STATIC_METHOD, Score

BLINK_POSE = MeasuredPose("blink", 0.1, 0.0, 0, 0.01, 0.0, 0.0)
JOY_ROW = motion.MotionRow("joy", 0.96, 1.0, 0.1, 0.8)
BETTER_SCORES = [
    Score(STATIC_METHOD, "joy", 1.0, 1.0, 10.0, 9.0),
    Score(BEST_METHOD, "joy", 2.0, 0.6, 6.0, 9.0),
]


def run(command, measured, *words):
    """Exit code and output of a benchmark with these measurements."""
    with pytest.MonkeyPatch.context() as patch:
        for (module, name), value in measured.items():
            patch.setattr(module, name, lambda *_, value=value, **__: value)
        ended = CliRunner().invoke(command, words)
    return ended.exit_code, ended.output


def of_gaps(**change):
    poses = [*[BLINK_POSE] * 99, BLINK_POSE._replace(**change)]
    return run(commands.bench_gaps, {(gaps, "measure"): poses})


def of_motion(**change):
    measured = [*[JOY_ROW] * 9, JOY_ROW._replace(**change)], []
    return run(commands.bench_motion, {(motion, "measure"): measured}, "--reference", ".")


def of_quality(**change):
    scores = [BETTER_SCORES[0], BETTER_SCORES[1]._replace(**change)]
    measured = {(subjects, "built_in"): None, (quality, "measure"): scores}
    return run(commands.bench_quality, measured)


@pytest.mark.parametrize(
    ("bench", "broken"),
    [
        (of_gaps, {"slit": 0.3}),
        (of_gaps, {"eye": 0.3}),
        (of_gaps, {"inverted": 4}),
        (of_gaps, {"teeth": 0.2}),
        (of_motion, {"cosine": 0.87}),
        (of_motion, {"cosine": 0.1}),
        (of_quality, {"distance": 0.9}),
        (of_quality, {"picture": 9.9}),
    ],
)  # fmt: skip
def test_a_missed_target_is_reported_and_ends_with_one(bench, broken):
    """The command prints "met" for each met target, and ends with 0 if none is missed."""
    code, output = bench()
    assert code == 0
    assert "  met     " in output
    assert "MISSED" not in output
    code, output = bench(**broken)
    assert code == 1
    assert "  MISSED  " in output


@pytest.mark.slow
def test_table_of_gaps():
    """The table has every row, also of mixed poses, and names the worst pose."""
    text = gaps.report(poses := gaps.measure(3))
    assert f"{len(poses)} poses" in text
    assert len(poses) > 203
    assert text.splitlines()[-1].startswith("teeth")
