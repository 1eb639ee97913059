"""Wrong inputs of every kind: shared fixtures."""

from collections.abc import Callable
from pathlib import Path

import click
import pytest

from risorius.app.scenes import SCENES, FaceScene

from .sandbox import put_files

LONG_WORK = (
    "risorius.bench.reproduce.figure_8.outcome",
    "risorius.bench.reproduce.figure_9.outcome",
    "risorius.bench.reproduce.figure_10.outcome",
    "risorius.app.viewer.window.splash_screen.SplashScreen",
    "risorius.bench.gaps.measure",
    "risorius.bench.motion.measure",
    "risorius.bench.quality.measure",
    "risorius.bench.refine.measure",
    "risorius.bench.reproduce.experiments.Experiment.run",
    "risorius.bench.window.measure",
)


@pytest.fixture(scope="session")
def face() -> FaceScene:
    """The built-in face."""
    return FaceScene()


@pytest.fixture
def sandbox(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with files of every kind, without a screen and without user settings."""
    put_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "folder"))
    return tmp_path


@pytest.fixture
def ready_face(face: FaceScene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the same face to every command that needs the built-in one."""
    monkeypatch.setitem(SCENES, "face", lambda *_: face)


@pytest.fixture
def no_long_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace long work by immediate success: the program accepted an input that gets this far."""
    for name in LONG_WORK:
        monkeypatch.setattr(name, _accepted(name))


def _accepted(name: str) -> Callable[..., object]:
    def work(*_: object, **__: object) -> object:
        raise click.exceptions.Exit(0)

    work.__name__ = name.rpartition(".")[2]
    return work
