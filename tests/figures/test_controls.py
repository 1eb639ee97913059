"""The program behind the pictures of docs/controls.md."""

from pathlib import Path

import controls
import numpy as np
import pytest
from PIL import Image

from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene


@pytest.mark.slow
def test_some_controls_are_drawn(tmp_path: Path) -> None:
    """Two views of each; a face that does something looks different."""
    controls.main([str(tmp_path), "--width", "48", "--only", "viseme_sil", "AU27"])
    image = np.asarray(Image.open(tmp_path / "some.webp").convert("RGB"))
    assert image.shape[1] == 4 * 48
    rest, opened = image[:50, :96].astype(int), image[:50, 96:].astype(int)
    assert rest.std() > 10.0
    assert np.abs(rest - opened).max() > 50


def test_an_unknown_control_is_named(tmp_path: Path) -> None:
    """A typing error is no traceback."""
    with pytest.raises(UserError, match="there is no control called 'AU127'"):
        controls.main([str(tmp_path), "--width", "48", "--only", "AU127"])


def test_one_tile_for_both_sides() -> None:
    """Sides of a pair get no tile of their own; a name that only has sides does."""
    names = ("AU1", "AU1_left", "AU1_right", "AU30_left", "AU30_right")
    assert controls.without_sides(names) == ["AU1", "AU30_left", "AU30_right"]
    assert controls.without_sides(("eyeBlinkLeft", "eyeBlinkRight", "jawOpen")) == [
        "eyeBlinkLeft", "jawOpen",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("count", "columns"), [(1, 1), (2, 2), (5, 5), (12, 4), (15, 5), (45, 5), (7, 4), (11, 4)]
)
def test_columns_leave_few_cells_empty(count: int, columns: int) -> None:
    """Four columns, unless another number fills the last row better; never an empty column."""
    assert controls.columns_for(count) == columns


def test_every_sheet_is_full() -> None:
    """No tile of the built-in head's sheets stands alone in the last row."""
    groups = FaceScene().groups
    for title in controls.LAYERS:
        count = len(controls.without_sides(groups[title]))
        assert count % controls.columns_for(count) == 0, title
