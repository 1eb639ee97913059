"""The pictures of docs/refinement.md and the paper's figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import refinement
from PIL import Image

from risorius.bench.reproduce import figure_coherence


@pytest.mark.slow
def test_figures_are_drawn(tmp_path: Path) -> None:
    """Every figure of the page, and ink on each; the same again to the last pixel."""
    refinement.main([str(tmp_path)])
    for name, figure in refinement.FIGURES.items():
        drawn = np.asarray(Image.open(tmp_path / f"{name}.webp"))
        assert 0.01 < (drawn.min(axis=2) < 128).mean() < 0.8
        assert name == "refine_tension" or (figure() == drawn).all()


def test_film_strip() -> None:
    """Red lines are in the row without memory, and none in the row with it."""
    outcome = figure_coherence.coherence((120, 96))
    drawn = outcome.pictures["coherence"].astype(int)
    assert drawn.shape[1] == len(figure_coherence.AMPLITUDES) * 120
    is_red = (drawn[..., 0] > 150) & (drawn[..., 1:].max(axis=2) < 90)
    half = len(drawn) // 2
    assert is_red[:half].sum() > 200
    assert is_red[half:].sum() == 0
    assert outcome.values["lines turned without memory"] > 100
    assert outcome.values["lines turned with memory"] == 0
