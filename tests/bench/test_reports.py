"""The tables that `risorius bench` prints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from risorius import assets
from risorius.bench.playing.commands import bench_capture, bench_window
from risorius.bench.report import table
from risorius.bench.scans import motion
from risorius.bench.simulation import soak, tearing


@pytest.mark.slow
def test_motion_table(tmp_path: Path) -> None:
    """A reference of one's own, here the built-in head pulled up at the brows, is scored."""
    head = assets.load("head")
    lifts = {}
    for side, landmark in (("L", 23), ("R", 20)):
        off = (head.vertices - head.vertices[head.landmarks[landmark]]) / 20.0
        near = np.exp(-(off**2).sum(axis=1))
        lifts[side] = near[:, None] * np.array([0.0, 8.0, 0.0])
    lift = lifts["L"] + lifts["R"]
    zero = np.zeros_like(lift)
    shapes = ("browInnerUp", "browDown", "eyeBlink", "noseSneer", "mouthSmile", "mouthFrown")
    shapes += ("mouthStretch", "mouthLowerDown")
    fields = {f"{name}_{side}": lifts[side] for name in shapes for side in "LR"}
    np.savez(
        tmp_path / "face.npz",
        vertices=head.vertices,
        triangles=head.faces,
        landmarks68=head.landmarks,
        jawOpen=zero + lift,
        mouthPucker=zero + lift,
        earWiggle=lift,
        **fields,
    )
    text = motion.report(*motion.measure(tmp_path))
    rows, _, unknown = text.partition("mean")
    scores = {line.split()[0]: float(line.split()[1]) for line in rows.splitlines()[6:]}
    for side in "LR":
        assert scores[f"browInnerUp_{side}"] > 0.5
        assert scores[f"browInnerUp_{side}"] > scores[f"browDown_{side}"]
    assert set(fields) < set(scores)
    assert unknown.splitlines()[-1].endswith(": earWiggle")


@pytest.mark.slow
def test_soak_table() -> None:
    """A few seconds of wild input are reported, and the face stays sound."""
    found = soak.measure(minutes=0.05)
    text = soak.report(found)
    assert "NO" not in text and all(target.is_met for target in soak.targets(found))
    assert "0.1 simulated minutes" in text or "0.0 simulated minutes" in text


@pytest.mark.slow
def test_tearing_table() -> None:
    """Expressions and mixtures are looked at, and the worst is named."""
    text = tearing.report(tearing.measure(mixtures=3), 3)
    assert "3 random mixtures" in text
    assert text.splitlines()[-1].startswith("teeth")


def test_table() -> None:
    """Titles stand over their columns; text goes left, and for None stands what is asked."""
    lines = table("name:<6|ms:6.2f|n:3d", [("a", 1.0, 2), ("b", None, 30)], empty="-")
    assert lines == ["name       ms   n", "a        1.00   2", "b           -  30"]
    assert table("x:>4", [(None,)], indent="  ") == ["     x", ""]


def test_help_tells_sizes_plainly() -> None:
    """As all commands do, without the brackets of a Python tuple."""
    for command in (bench_capture, bench_window):
        told = CliRunner().invoke(command, ["--help"]).output
        assert "1280x720 unless told." in told and "(1280" not in told
