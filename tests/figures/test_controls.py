"""The programs behind the pictures of docs/controls.md and docs/head.md."""

import controls
import head
import numpy as np
import pytest

from risorius.app.scenes import FaceScene


@pytest.mark.slow
def test_portraits_of_a_control() -> None:
    """Two views of each; a face that does something looks different."""
    scene = FaceScene()
    rest, opened = (controls.portrait(scene, name, (48, 54)) for name in ("viseme_sil", "AU27"))
    assert rest.shape == (54, 2 * 48, 3) and rest.std() > 10.0
    assert np.abs(rest.astype(int) - opened).max() > 50


@pytest.mark.slow
def test_views_of_the_head() -> None:
    """Four portraits wide, a row for each style, and something is on each portrait."""
    sheet = head.views((48, 60))
    assert sheet.shape[1] == 4 * 48
    for row in np.split(sheet, len(head.STYLES)):
        assert all(cell[:48].std() > 10.0 for cell in np.split(row, 4, axis=1))


def test_one_tile_for_both_sides() -> None:
    """Sides of a pair get no tile of their own; a name that only has sides does."""
    names = ("AU1", "AU1_left", "AU1_right", "AU30_left", "AU30_right")
    assert controls.without_sides(names) == ["AU1", "AU30_left", "AU30_right"]
    assert controls.without_sides(("eyeBlinkLeft", "eyeBlinkRight", "jawOpen")) == [
        "eyeBlinkLeft", "jawOpen",
    ]  # fmt: skip


def test_every_sheet_is_full() -> None:
    """No tile of the built-in head's sheets stands alone in the last row; turned heads are some."""
    groups = FaceScene().groups
    for title in controls.LAYERS.values():
        count = len(controls.without_sides(groups[title]))
        assert count % controls.columns_for(count) == 0, title
    assert set(controls.TURNING) <= set(groups["Action units"])
