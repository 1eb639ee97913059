"""The program behind the pictures of docs/head.md."""

from pathlib import Path

import head
import numpy as np
import pytest
from figures import FOLDER
from PIL import Image

LARGEST_IMAGE_FILE = 600_000  # bytes, at full size


@pytest.mark.slow
def test_both_sheets_are_drawn(tmp_path: Path) -> None:
    """Two images, four portraits wide, and something is on each portrait."""
    head.main([str(tmp_path), "--width", "48", "--only", "head_views", "head_details"])
    for name, rows in (("head_views.png", 3), ("head_details.png", 2)):
        sheet = np.asarray(Image.open(tmp_path / name))
        assert sheet.shape[1] == 4 * 48
        height = sheet.shape[0] // rows
        for row in range(rows):
            for column in range(4):
                cell = sheet[row * height : row * height + 48, column * 48 : (column + 1) * 48]
                assert cell.std() > 10.0


def test_pictures_of_the_page_are_small() -> None:
    """They travel with the source."""
    for name in ("head_views.png", "head_details.png"):
        image = Path(__file__).parents[2] / FOLDER / name
        assert image.stat().st_size < LARGEST_IMAGE_FILE
