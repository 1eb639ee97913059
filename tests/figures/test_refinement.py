"""The pictures of docs/refinement.md."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import refinement
from PIL import Image


@pytest.mark.slow
def test_figures_are_drawn(tmp_path: Path) -> None:
    """Every figure of the page, and ink on each; the same again to the last pixel."""
    refinement.main([str(tmp_path)])
    for name, figure in refinement.FIGURES.items():
        drawn = np.asarray(Image.open(tmp_path / f"{name}.webp"))
        assert 0.01 < (drawn.min(axis=2) < 128).mean() < 0.8
        assert name == "refine_tension" or (figure() == drawn).all()
