"""The program behind the pictures of docs/head.md."""

from pathlib import Path

import head
import numpy as np
import pytest
from PIL import Image


@pytest.mark.slow
def test_both_sheets_are_drawn(tmp_path: Path) -> None:
    """Two images, four portraits wide, and something is on each portrait."""
    head.main([str(tmp_path), "--width", "48", "--only", "head_views", "head_details"])
    for name, rows in (("head_views.webp", 3), ("head_details.webp", 2)):
        sheet = np.asarray(Image.open(tmp_path / name))
        assert sheet.shape[1] == 4 * 48
        height = sheet.shape[0] // rows
        for row in range(rows):
            for column in range(4):
                cell = sheet[row * height : row * height + 48, column * 48 : (column + 1) * 48]
                assert cell.std() > 10.0
