"""Unsaved work outlives the window: kept while one works, offered at the next start."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from risorius.app.errors import UserError
from risorius.app.performances import script_for
from risorius.app.scenes import PlaneScene
from risorius.app.viewer import Viewer
from risorius.app.viewer.session.physics import STEP
from risorius.app.viewer.session.recovery import INTERVAL, Recovery, Work
from risorius.app.viewer.session.session import Session

from .driving import NEEDS_A_SCREEN, SIZE, click, run, settle, wait_for, xdotool

ROOT = Path(__file__).parents[2]


class Clock:
    """Time that passes when it is told to."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    """A clock that stands still."""
    return Clock()


@pytest.fixture
def recovery(session: Session, tmp_path: Path, clock: Clock) -> Iterator[Recovery]:
    """Of a window that lives."""
    made = Recovery(tmp_path, session, clock)
    yield made
    made.close()


def watch(recovery: Recovery, clock: Clock) -> None:
    """Let the time pass in which a change is written."""
    recovery.watch()
    clock.now += INTERVAL
    recovery.watch()


def stored(folder: Path) -> list[str]:
    """The files with unsaved work."""
    return [path.name for path in folder.glob("unsaved*.json")]


def found_by_next(folder: Path, session: Session) -> Work | None:
    """What a window that opens now would offer."""
    other = Recovery(folder, session)
    other.close()
    return other.found


def leave(folder: Path, session: Session) -> None:
    """Work that a window has which then ends."""
    recovery = Recovery(folder, session)
    recovery.save()
    recovery.close()


def test_work_is_written_soon_and_goes_when_it_is_undone(
    session: Session, recovery: Recovery, clock: Clock, tmp_path: Path
) -> None:
    """Nothing at first; a pose a moment later, though it is dragged on; nothing when undone."""
    recovery.watch()
    assert recovery.due_in() == float("inf") and not stored(tmp_path)
    for step in range(round(1.5 * INTERVAL / STEP)):
        session.set("jaw_open", 0.2 + 0.001 * (step % 100))
        recovery.watch()
        clock.now += STEP
    recovery.close()
    found = found_by_next(tmp_path, session)
    assert found is not None and 0.2 <= found.pose["jaw_open"] < 0.3
    session.note()
    session.undo()
    recovery.watch()
    assert not stored(tmp_path)


def test_saved_work_is_kept_no_more(
    session: Session, recovery: Recovery, clock: Clock, tmp_path: Path
) -> None:
    """The script goes when it is in its own file, the pose stays until it is."""
    session.set("jaw_open", 0.4)
    session.edit(replace(session.script, duration=5.0))
    watch(recovery, clock)
    session.save_script(tmp_path / "own.toml")
    watch(recovery, clock)
    recovery.close()
    found = found_by_next(tmp_path, session)
    assert found is not None and found.pose == {"jaw_open": 0.4} and not found.script
    session.save_pose(tmp_path / "pose.toml")
    recovery.watch()
    assert not stored(tmp_path)


def test_all_of_it_comes_back(session: Session, recovery: Recovery, tmp_path: Path) -> None:
    """A script with what is being recorded, to each digit; it knows its file, comments and all."""
    session.set("jaw_open", 0.25)
    session.set_key()
    session.set("jaw_open", 1.0 / 3.0)
    session.toggle_recording()
    session.set("jaw_open", 0.5)
    run(session, 20)
    recovery.save()
    assert found_by_next(tmp_path, session) is None  # its window still lives
    recovery.close()
    after = Session(session.scene, script_for(None, "face"))
    next_one = Recovery(tmp_path, after)
    assert next_one.found is not None and next_one.found.summary == "the script own.toml"
    next_one.accept_found()
    assert next_one.found is None and after.unsaved == "the script"
    session.toggle_recording()
    assert after.script == session.script and after.script.preface.startswith("# A smile")
    assert after.file.path == tmp_path / "own.toml" and after.file.objection == ""
    next_one.close()
    assert found_by_next(tmp_path, session) is not None


def test_an_offer_that_nobody_answers_is_made_again(session: Session, tmp_path: Path) -> None:
    """Whatever is done, saved or given up meanwhile; thrown away, it is gone."""
    session.set("jaw_open", 0.4)
    leave(tmp_path, session)
    session.neutral()
    recovery = Recovery(tmp_path, session)
    with recovery.guarding():
        recovery.watch()
        session.set("jaw_open", 0.1)
        recovery.save()
    recovery.close()
    recovery = Recovery(tmp_path, session)
    assert recovery.found is not None and recovery.found.pose == {"jaw_open": 0.4}
    recovery.discard()
    assert not stored(tmp_path)
    recovery.close()


@pytest.mark.parametrize("damaged", [b"nonsense", bytes(range(256)), b'{"when": 1.0}'])
def test_only_what_is_of_use_is_offered(session: Session, tmp_path: Path, damaged: bytes) -> None:
    """No damaged file; and a window with the plane leaves a face's pose to one with a face."""
    session.set("jaw_open", 0.4)
    leave(tmp_path, session)
    assert found_by_next(tmp_path, Session(PlaneScene(), script_for(None, "plane"))) is None
    assert found_by_next(tmp_path, session) is not None
    (tmp_path / "unsaved-face.json").write_bytes(damaged)
    assert found_by_next(tmp_path, session) is None


def test_a_folder_that_takes_nothing_is_told_once(session: Session, clock: Clock) -> None:
    """The user is told that work is not safe, and works on."""
    recovery = Recovery(Path("/proc/none"), session, clock)
    session.set("jaw_open", 0.4)
    with pytest.raises(UserError, match=r"not kept safe: .*/proc/none"):
        watch(recovery, clock)
    session.set("jaw_open", 0.5)
    watch(recovery, clock)
    recovery.close()


# Real windows, real signals


@pytest.fixture
def at_work(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """`risorius view`, with settings of its own, in which somebody has made a face just now."""
    process = subprocess.Popen(
        [sys.executable, "-m", "risorius", "view", "--size", "700x500"],
        cwd=ROOT, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "XDG_CONFIG_HOME": str(tmp_path)}, start_new_session=True,
        # Tests that run behind an `&` or `nohup` have signals ignored, and pass that on.
        preexec_fn=lambda: [signal.signal(n, signal.SIG_DFL) for n in (1, 2, 15)],
    )  # fmt: skip
    search = ["xdotool", "search", "--onlyvisible", "--name"]

    def is_posed() -> bool:
        subprocess.run(["xdotool", "mousemove", "450", "200", "key", "n", "1", "m"], check=True)
        title = [*search, r"^Risorius: Expressions \*$"]
        return bool(subprocess.run(title, capture_output=True, check=False).stdout)

    try:
        shown = [*search[:2], "--sync", *search[2:], "^Risorius: Expressions$"]
        subprocess.run(shown, check=True, capture_output=True, timeout=60)
        wait_for(is_posed)
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.window
@NEEDS_A_SCREEN[1]
@pytest.mark.parametrize("how", [signal.SIGHUP, signal.SIGKILL])
def test_a_window_that_ended_is_recovered(
    at_work: subprocess.Popen[str], tmp_path: Path, how: signal.Signals
) -> None:
    """Told to stop, or killed some seconds after the last change; it is offered until answered."""
    folder = tmp_path / "risorius"
    if how == signal.SIGKILL:
        wait_for(lambda: stored(folder))
    at_work.send_signal(how)
    assert at_work.wait(60.0) == -how
    script = script_for(None, "face")
    for answer in ("Recover", "Throw away"):
        with Viewer(script, SIZE, settings_path=folder / "viewer.json") as viewer:
            settle(viewer)
            assert not viewer.session.unsaved and viewer.recovery.found is not None
            assert viewer.recovery.found.pose == {"joy": 1.0}
            click(viewer, f"offer: {answer}")
            assert "offer: Recover" not in viewer.gui.places
            if answer == "Recover":
                assert viewer.session.unsaved == "the pose"
                assert viewer.session.is_alone("joy")
    assert not stored(folder)


@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_other_work_is_asked_for_and_can_be_given_up(session: Session, tmp_path: Path) -> None:
    """Going back keeps both; what is closed without saving is not offered again."""
    session.set("jaw_open", 0.4)
    leave(tmp_path, session)
    script = script_for(None, "face")
    with Viewer(script, SIZE, settings_path=tmp_path / "viewer.json") as viewer:
        settle(viewer)
        viewer.session.set("AU12", 0.7)
        click(viewer, "offer: Recover")
        click(viewer, "question: Back")
        assert viewer.session.values["AU12"] == 0.7 and viewer.recovery.found is not None
        click(viewer, "offer: Recover")
        click(viewer, "question: Recover without saving")
        assert viewer.session.values["AU12"] == 0.0 and viewer.session.values["jaw_open"] == 0.4
        xdotool(viewer, "key", "ctrl+q")
        click(viewer, "question: Close without saving")
        viewer.run()
    assert not stored(tmp_path)
