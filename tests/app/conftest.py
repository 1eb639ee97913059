"""Fixtures shared by tests: the window in a known state, faces, and a Dask cluster."""

import functools
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from risorius.app import motion, scenes
from risorius.app.performances import script_for
from risorius.app.scenes import FaceScene
from risorius.app.script.key_sets import NO_KEYS
from risorius.app.script.script_file import load_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.documents.file_dialogs import FileDialogs
from risorius.app.viewer.picture.portraits import Portraits
from risorius.app.viewer.session.session import Session, Work
from risorius.app.viewer.settings import Display, Settings
from risorius.assets.fitting import FittedHead

from .driving import HELLO_FILE, SIZE, replace_state, settle, xdotool


@pytest.fixture(scope="session")
def scene() -> FaceScene:
    """One face for all tests that only pose it."""
    return FaceScene()


@pytest.fixture
def face(scene: FaceScene) -> FaceScene:
    """The same face, at rest."""
    scene.reset()
    return scene


@pytest.fixture
def session(face: FaceScene, tmp_path: Path) -> Session:
    """A session with a user's script of poses and a blink."""
    path = tmp_path / "own.toml"
    path.write_text(HELLO_FILE.read_text(encoding="utf-8"))
    return Session(face, load_script(path))


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    """One window for all tests of a file."""
    script = replace(script_for(None, "face"), duration=0.5)
    with Viewer(script, SIZE) as opened:
        opened.settings.is_alive = False  # so that compared pictures do not move
        draw_few_portraits(opened.context.portraits)
        settle(opened)
        yield opened


def draw_few_portraits(portraits: Portraits) -> None:
    """Draw pictures of three persons only, because all 25 keep a core busy for a minute."""
    begin = portraits.begin
    portraits.begin = lambda people: begin(people[:3])  # type: ignore[method-assign]


@pytest.fixture
def calm(viewer: Viewer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Start from the neutral face with refinement on, in a folder of this test alone."""
    monkeypatch.chdir(tmp_path)
    xdotool(viewer, "mousemove", 2, 2, "key", "Escape")
    script = replace(script_for(None, "face"), duration=0.5)
    replace_state(viewer.session, Session(viewer.session.scene, script))
    viewer.session.work = Work(viewer.session)
    viewer.session.scene.reset()
    viewer.settings.display = Display()
    viewer.settings.is_linked = True
    viewer.settings.panel_width = Settings().panel_width
    viewer.face.face_panel.search = ""
    viewer.settings.folds.clear()
    replace_state(viewer.files, FileDialogs())
    viewer.messages.text = ""
    viewer.context.wanted_tab = "Face"
    viewer.face.view.fit_scene()
    settle(viewer)


@pytest.fixture
def own(viewer: Viewer, tmp_path: Path, calm: None) -> Path:
    """A user's script with poses and a blink, opened in rows of keys."""
    path = tmp_path / "own.toml"
    path.write_text(HELLO_FILE.read_text(encoding="utf-8"))
    viewer.session.work.open(load_script(path))
    viewer.face.selection.keys = NO_KEYS
    viewer.settings.shows_curves = False
    viewer.face.time_axis.show_whole_script()
    settle(viewer)
    return path


@pytest.fixture(scope="module")
def shared_scenes() -> Iterator[None]:
    """Commands of a file share scenes of the built-in head, each reset before use."""
    built = motion.build_scene
    shared = functools.cache(built)
    with pytest.MonkeyPatch.context() as this_process:
        this_process.setattr(
            motion,
            "build_scene",
            lambda name, head=None: shared(name) if head is None else built(name, head),
        )
        yield


@pytest.fixture(scope="module")
def shared_fits() -> Iterator[None]:
    """Commands of a file fit a head once, unless its files change."""
    fit = scenes.fit_users_head
    fitted: dict[object, FittedHead] = {}

    def fit_once(head: Path, landmarks: Path | None) -> FittedHead:
        files = [path for path in (head, landmarks) if path is not None and path.is_file()]
        key = head, landmarks, tuple(path.stat().st_mtime_ns for path in files)
        if key not in fitted:
            fitted[key] = fit(head, landmarks)
        return fitted[key]

    with pytest.MonkeyPatch.context() as this_process:
        this_process.setattr(scenes, "fit_users_head", fit_once)
        yield


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """A Dask cluster of two worker processes."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as opened:
        yield opened
