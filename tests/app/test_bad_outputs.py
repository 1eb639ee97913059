"""Outputs that cannot be: told in one line before any work is done, and nothing is lost."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from .command_line import refusal, risorius

WRITERS = {
    "film": ("capture", "--set", "joy", "-o", "x.mp4"),
    "picture": ("capture", "--set", "joy", "-o", "x.png"),
    "sheet": ("capture", "--sheet", "x.png"),
    "figure": ("reproduce", "figure9", "-o", "x.png"),
}


@pytest.fixture(autouse=True)
def idle(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Whatever takes long fails, and names are those of an empty folder."""

    def work(*_: Any, **__: Any) -> None:
        raise AssertionError("it was begun")

    for name in (
        "risorius.app.capture.Capture.play",
        "risorius.bench.reproduce.figure_9.outcome",
    ):
        monkeypatch.setattr(name, work)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", WRITERS)
def test_a_place_that_cannot_be_written(command: str, tmp_path: Path) -> None:
    """A folder of the path that is a file, a name too long, a device: nobody waits for that."""
    *arguments, name = WRITERS[command]
    Path("file").write_text("mine")
    os.mkfifo("pipe" + Path(name).suffix)
    for loop in (Path("loop"), Path("circle" + Path(name).suffix)):
        loop.symlink_to(loop)
    for target, words in (
        (f"loop/{name}", "cannot be written: Too many levels of symbolic links"),
        (f"circle{Path(name).suffix}", "is a link that leads back to itself; choose another name"),
        (f"file/{name}", "cannot be written: Not a directory"),
        (f"{'x' * 300}{name}", "cannot be written: File name too long"),
        (f"pipe{Path(name).suffix}", "is a device, not a file"),
    ):
        line = refusal(risorius(*arguments, target))
        assert line.startswith(f"risorius: {target}: ") and words in line
    assert Path("file").read_text() == "mine"
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        (("-o", "smile.png"), "smile.png: is read and would be written"),
        (("--sheet", "./link.png"), "link.png: is read and would be written"),
        (("-o", "x.png", "--sheet", "../{folder}/x.png"), "is to be two outputs at once"),
    ],
)
def test_outputs_are_apart(outputs: tuple[str, ...], message: str, tmp_path: Path) -> None:
    """No output takes the place of an input, or of another output."""
    script = Path("smile.png")
    script.write_text("[[pose]]\ntime = 1\nname = 'joy'\njoy = 1\n")
    Path("link.png").symlink_to(script)
    named = [word.format(folder=tmp_path.name) for word in outputs]
    assert message in refusal(risorius("capture", "smile.png", *named))
    assert script.read_text().startswith("[[pose]]")
