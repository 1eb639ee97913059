"""The tables that `risorius bench` prints."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import assets
from app.benchmarks import motion_table, simulate_table


def test_simulate_table() -> None:
    """Head and plain meshes each get a row with their sizes."""
    table = simulate_table(2, sizes=(400,))
    assert "head, all muscles" in table
    assert "2030" in table
    assert "plain mesh" in table


def test_motion_table(tmp_path: Path) -> None:
    """A reference of one's own, here the built-in head pulled up at the brows, is scored."""
    head = assets.load("head")
    brow = head.vertices[head.landmarks[19]]
    near = np.exp(-(((head.vertices - brow) / 20.0) ** 2).sum(axis=1))
    lift = near[:, None] * np.array([0.0, 8.0, 0.0])
    zero = np.zeros_like(lift)
    shapes = ("browInnerUp", "browDown", "eyeBlink", "noseSneer", "mouthSmile", "mouthFrown")
    shapes += ("mouthStretch", "mouthLowerDown")
    fields = {f"{name}_{side}": lift for name in shapes for side in "LR"}
    np.savez(
        tmp_path / "face.npz",
        vertices=head.vertices,
        triangles=head.faces,
        landmarks68=head.landmarks,
        jawOpen=zero + lift,
        mouthPucker=zero + lift,
        **fields,
    )
    table = motion_table(tmp_path)
    scores = {line.split()[0]: float(line.split()[1]) for line in table.splitlines()[4:]}
    assert scores["browInnerUp"] > 0.5
    assert scores["browInnerUp"] > scores["browDown"]
    assert set(shapes) < set(scores)
