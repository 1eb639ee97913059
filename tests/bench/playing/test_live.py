"""What `risorius bench live` prints."""

from __future__ import annotations

import pytest

from risorius.app.live import PROTOCOLS
from risorius.bench.playing import live


@pytest.mark.slow
def test_every_protocol_is_timed_stage_by_stage(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames come, in all protocols, and none is in the skin before its longest stage is over."""
    monkeypatch.setattr(live, "ROUNDS", 1)
    text, target = live.report(1.0, with_window=False)
    lines = text.splitlines()
    for protocol in PROTOCOLS.values():
        index = next(i for i, line in enumerate(lines) if line.startswith(protocol.title))
        frames, _, title, *medians = lines[index].removeprefix(protocol.title).split()
        assert int(frames) > 30 and title == "median"
        *stages, whole = map(float, medians)
        assert min(stages) >= 0.0 and 0.0 < max(stages) <= whole
        assert lines[index + 1].split()[0] == "95"
    assert "at most 8 ms" in target.text
