"""Recordings of faces: what other programs write is read, in names, units and signs of ours."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from risorius.app.recordings import is_recording, read_take


def test_a_table_of_live_link_face(tmp_path: Path) -> None:
    """Times are from the timecode, shapes by their names, the count is no channel."""
    path = tmp_path / "take.txt"
    rows = [f"10:00:0{n // 60}:{n % 60:02}.000,61,{n / 100:.2f},0.5\n" for n in range(90)]
    path.write_text("Timecode,BlendShapeCount,JawOpen,MouthSmileLeft\n" + "".join(rows))
    assert is_recording(path)
    take = read_take(path)
    assert take.kind == "Live Link Face"
    assert set(take.channels) == {"jawOpen", "mouthSmileLeft"}
    assert take.times == pytest.approx(np.arange(90) / 60.0)
    assert take.channels["jawOpen"] == pytest.approx(np.arange(90) / 100.0)
