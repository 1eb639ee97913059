"""What a process keeps for the next piece of work: it changes nothing of what is made."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from risorius.app import process_cache

from .command_line import risorius

SCRIPT = """
duration = 0.3
[[pose]]
time = 0.0
{first} = 1.0
[[pose]]
time = 0.3
{second} = 1.0
"""
COMMANDS = {
    "joy": "capture joy.toml -o {0} --size 64x48 --fps 20",
    "a_word": "capture word.toml -o {0} --size 48x64 --samples 0 --fps 20 --alive",
    "a_drag": "capture joy.toml -o {0} --size 64x48 --fps 20 --option coherent=on --compare paper",
    "a_cloth": "capture cloth.toml -o {0} --scene cloth --size 64x48 --fps 20",
    "a_plane": "capture --set amplitude=1 --scene plane -o {0} --size 64x48 --fps 10",
    "a_clip": "export word.toml -o {0}/clip.npz --fps 20 --quiet",
}


def test_the_content_of_a_file_is_known_by_its_state(tmp_path: Path) -> None:
    """Another content, another place, or no file at all."""
    file, other = tmp_path / "a", tmp_path / "b"
    states = [process_cache.file_state(file)]
    for text in ("x", "xy"):
        file.write_text(text)
        states.append(process_cache.file_state(file))
    os.utime(file, ns=(1, 1))
    other.write_text("xy")
    os.utime(other, ns=(1, 1))
    states += [process_cache.file_state(file), process_cache.file_state(other)]
    assert len(set(states)) == len(states)


def made(folder: Path, command: str) -> dict[str, bytes]:
    """Every file that a command makes in a folder."""
    ended = risorius(*command.format(folder).split())
    assert ended.exit_code == 0, ended.output
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.slow
def test_work_before_changes_no_byte(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each command is done alone, and then after every other in one process that keeps."""
    monkeypatch.chdir(tmp_path)
    for name, first, second in (
        ("joy", "joy", "anger"),
        ("word", "tongue_out", "jaw_open"),
        ("cloth", "drop", "turn"),
    ):
        Path(f"{name}.toml").write_text(SCRIPT.format(first=first, second=second))
    alone = {name: made(Path("alone") / name, COMMANDS[name]) for name in COMMANDS}
    assert all(alone.values())
    process_cache.enable()
    try:
        for turn, names in enumerate((list(COMMANDS), list(reversed(COMMANDS)))):
            for name in names:
                assert made(Path(str(turn)) / name, COMMANDS[name]) == alone[name], name
        assert process_cache._cached
    finally:
        process_cache._cached = None
