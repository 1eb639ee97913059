"""`risorius doctor`: its verdict agrees with the commands, whichever parts are missing."""

import itertools
from pathlib import Path

import pytest

from risorius import render
from risorius.__main__ import command
from risorius.app.cli import doctor

from .command_line import report_lines, risorius


@pytest.fixture
def machine_without(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> object:
    """A function that makes a machine without the given parts."""

    def make(*missing):
        def probe(*, offscreen_only=False):
            names = ["offscreen"] if offscreen_only else ["offscreen", "window"]
            return [
                render.Finding(name, name not in missing, "" if name not in missing else "Cure: x")
                for name in names
            ]

        fake = tmp_path / "ffmpeg"
        fake.write_text(f"#!/bin/sh\necho ffmpeg version 7\nexit {int('films' in missing)}\n")
        fake.chmod(0o755)
        monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(fake))
        monkeypatch.setattr(render, "probe", probe)

    return make


def ask(*options):
    """Run the command."""
    return risorius("doctor", *options)


CHECKED_PARTS = ("offscreen", "window", "films")


def test_every_command_is_said_to_work_or_not(machine_without):
    """Without a screen, all commands are reported to work except those of the window."""
    machine_without("window")
    able, _, unable = report_lines(ask().output)["commands"].partition(" work; ")
    assert unable == "view, replay do not"
    assert set(able.split(", ")) == set(command().commands) - {"view", "replay", "doctor"}
    machine_without()
    assert "commands: all work" in ask().output


@pytest.mark.parametrize(
    "missing", [each for count in range(4) for each in itertools.combinations(CHECKED_PARTS, count)]
)
def test_the_verdict_agrees_with_the_parts(machine_without, missing):
    """For each missing part, its line, the summary and the exit code agree."""
    machine_without(*missing)
    result = ask()
    lines = report_lines(result.output)
    for part in CHECKED_PARTS:
        assert lines[part].startswith("no." if part in missing else "yes.")
    assert ("Everything is there." in result.output) == (not missing)
    assert lines.get("Missing", "").startswith(", ".join(missing))
    draws = not {"offscreen", "window"} <= set(missing)
    assert result.exit_code == (0 if not missing else 1 if draws else 2)
    assert ask("--quiet").output == ""
    assert ask("--quiet").exit_code == result.exit_code


@pytest.mark.parametrize(
    ("able", "is_software", "message"),
    [
        ((), True, "no. It needs OpenGL 4.3; the refiner kahler does the same"),
        (("window",), False, "yes (window)"),
        (
            ("offscreen", "window"),
            True,
            "yes (offscreen, window), by software, where the refiner kahler is faster",
        ),
    ],
)
def test_refinement_on_the_card(able, is_software, message, monkeypatch):
    """A line reports whether kahler-gl would run, and on which card; its absence is not a fault."""
    findings = [
        render.Finding(name, True, is_software=is_software, lends_gpu_streams=name in able)
        for name in ("offscreen", "window")
    ]
    monkeypatch.setattr(render, "probe", lambda **_: findings)
    assert f"\nkahler-gl: {message}\n" in ask().output


@pytest.mark.parametrize("missing", [(), ("offscreen",), ("window", "films")])
def test_offscreen_alone(machine_without, missing):
    """A part that was not asked for is reported neither as missing nor as present."""
    machine_without(*missing)
    result = ask("--offscreen")
    assert result.exit_code == (2 if "offscreen" in missing else 0)
    assert "window" not in result.output
    assert "films" not in result.output
    assert ("Everything is there." in result.output) == ("offscreen" not in missing)


@pytest.mark.parametrize("program", ["exec sleep 100", "exec >&-; exit 3", None])
def test_an_ffmpeg_that_does_not_answer(machine_without, tmp_path, monkeypatch, program):
    """An ffmpeg that hangs, fails or does not exist counts as missing, without a long wait."""
    machine_without()
    monkeypatch.setattr(doctor, "VERSION_TIMEOUT", 0.3)
    fake = tmp_path / "ffmpeg"
    fake.unlink() if program is None else fake.write_text(f"#!/bin/sh\n{program}\n")
    result = ask()
    assert result.exit_code == 1
    assert "films: no. " in result.output
    assert str(fake) in result.output
    assert "Cure: unset IMAGEIO_FFMPEG_EXE" in result.output
