"""Glasses and collars of persons, a few pixels wide."""

from pathlib import Path

import numpy as np
import pytest

from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Studio
from risorius.assets import Segment
from risorius.assets.identities import COLLAR_BUILDERS


@pytest.mark.slow
def test_rims_are_not_dashed_by_highlights():
    """A rim of one or two pixels has no row of light dots, for any normals."""
    studio = Studio(request_of(Path(), seed=21, size=(192, 192), passes=("segmentation",)))
    shot = studio.shoot(2)
    assert shot.known.labels["person"]["glasses"] == "rectangular"
    is_rim = shot.known.images["segmentation"] == Segment.GLASSES
    assert is_rim.sum() > 400
    lightness = shot.image[is_rim] @ np.array([0.2126, 0.7152, 0.0722])
    assert (lightness > 110).mean() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("collar", COLLAR_BUILDERS)
def test_rows_of_the_table_choose_collars(tmp_path: Path, collar: str):
    """A row of the table gives every person this collar, with its label and class clothing."""
    table = tmp_path / "collars.toml"
    table.write_text(f"[collars]\n{collar} = 1.0\n[masks]\nnone = 1.0\n")
    size = (160, 160)
    request = request_of(tmp_path, seed=3, size=size, passes=("segmentation",), sample=table)
    shot = Studio(request).shoot(0)
    assert shot.known.labels["person"]["collar"] == collar
    assert (shot.known.images["segmentation"] == Segment.CLOTHING).sum() > 300
    assert set(COLLAR_BUILDERS) == {"band", "roll", "v", "wings"}
