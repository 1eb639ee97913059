"""What `risorius bench live` prints."""

from __future__ import annotations

from risorius.app.live import PROTOCOLS
from risorius.bench import live


def test_every_protocol_is_timed_stage_by_stage() -> None:
    """Frames come, in all protocols, and the stages of each add up to its whole."""
    text = live.report(1.0, with_window=False)
    lines = text.splitlines()
    for protocol in PROTOCOLS.values():
        index = next(i for i, line in enumerate(lines) if line.startswith(protocol.title))
        numbers = lines[index].removeprefix(protocol.title).split()
        assert int(numbers[0]) > 30 and numbers[2] == "median"
        assert lines[index + 1].split()[0] == "95"
    assert "median below 8 ms" in lines[-1]
