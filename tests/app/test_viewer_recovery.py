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
from risorius.app.scenes import FaceScene, PlaneScene
from risorius.app.script import load_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.session.physics import STEP
from risorius.app.viewer.session.recovery import LONGEST, QUIET, Recovery
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.session.unsaved import Work
from risorius.assets.staging import PREFIX

from .driving import DEADLINE, NEEDS_A_SCREEN, SIZE, click, settle, wait_for, xdotool

ROOT = Path(__file__).parents[2]
SCRIPT = "# mine\nduration = 2.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n"


class Clock:
    """Time that passes when it is told to."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def session(scene: FaceScene, tmp_path: Path) -> Session:
    """A script of the user's own, opened from a file."""
    scene.reset()
    path = tmp_path / "smile.toml"
    path.write_text(SCRIPT)
    return Session(scene, load_script(path))


@pytest.fixture
def clock() -> Clock:
    """A clock that stands still."""
    return Clock()


@pytest.fixture
def recovery(tmp_path: Path, clock: Clock) -> Iterator[Recovery]:
    """Of a window that lives."""
    made = Recovery(tmp_path / "unsaved", clock)
    yield made
    made.close()


def stored_work(folder: Path) -> dict[str, str]:
    """The texts that are kept there, by kind."""
    return {file.name.split(".")[1]: file.read_text() for file in folder.glob("unsaved/*.toml")}


def found_by_next(folder: Path, session: Session) -> Work | None:
    """What a window that opens now would offer."""
    other = Recovery(folder / "unsaved")
    other.find(session)
    found = other.found
    other.close()
    return found


def test_work_is_written_after_a_pause(
    session: Session, recovery: Recovery, clock: Clock, tmp_path: Path
) -> None:
    """Nothing at first; a pose when it was left alone for a while; nothing again when undone."""
    recovery.watch(session)
    assert recovery.due_in() == float("inf") and not (tmp_path / "unsaved").exists()
    session.set("jaw_open", 0.4)
    recovery.watch(session)
    assert stored_work(tmp_path) == {} and recovery.due_in() == pytest.approx(QUIET)
    clock.now += 0.9 * QUIET
    recovery.watch(session)
    assert stored_work(tmp_path) == {}
    clock.now += 0.2 * QUIET
    recovery.watch(session)
    assert "jaw_open = 0.4" in stored_work(tmp_path)["pose"] and recovery.due_in() == float("inf")
    session.note()
    session.undo()
    recovery.watch(session)
    assert list((tmp_path / "unsaved").iterdir()) == []


def test_work_without_a_pause_is_written_too(
    session: Session, recovery: Recovery, clock: Clock, tmp_path: Path
) -> None:
    """Whoever drags a slider to and fro for long loses a few seconds at most."""
    recovery.watch(session)
    for step in range(round(1.5 * LONGEST / STEP)):
        session.set("jaw_open", 0.2 + 0.001 * (step % 100))
        recovery.watch(session)
        clock.now += STEP
    written = load_script(next((tmp_path / "unsaved").glob("*.pose.toml"))).at(0.0)["jaw_open"]
    assert 0.2 <= written < 0.3


@pytest.mark.slow
def test_a_recording_is_kept_while_it_goes_on(
    session: Session, recovery: Recovery, clock: Clock, tmp_path: Path
) -> None:
    """What was recorded some seconds ago is in the file, near to what stopping would give."""
    session.toggle_recording()
    for step in range(round(4.0 * LONGEST / STEP)):
        session.set("jaw_open", 0.5 - 0.5 / (1.0 + 0.02 * step))
        session.advance(STEP)
        clock.now += STEP
        recovery.watch(session)
    draft = load_script(next((tmp_path / "unsaved").glob("*.recording.toml")))
    assert session.recorded_seconds - LONGEST - 0.1 < draft.duration < session.recorded_seconds
    session.toggle_recording()
    for moment in (0.3, 1.0, 5.0, draft.duration):
        wanted = session.script.at(moment)["jaw_open"]
        assert draft.at(moment)["jaw_open"] == pytest.approx(wanted, abs=5e-3)
    whole = len(session.script.tracks["jaw_open"].keys)
    assert len(draft.tracks["jaw_open"].keys) < whole + 10


def test_saved_work_is_kept_no_more(
    session: Session, recovery: Recovery, clock: Clock, tmp_path: Path
) -> None:
    """The script goes from the folder when it is in its own file, the pose stays until it is."""
    session.set("jaw_open", 0.4)
    session.edit(replace(session.script, duration=3.0))
    recovery.watch(session)
    clock.now += QUIET
    recovery.watch(session)
    assert set(stored_work(tmp_path)) == {"script", "pose"}
    session.save_script(tmp_path / "smile.toml")
    recovery.watch(session)
    clock.now += QUIET
    recovery.watch(session)
    assert set(stored_work(tmp_path)) == {"pose"}
    session.save_pose(tmp_path / "pose.toml")
    recovery.watch(session)
    assert list((tmp_path / "unsaved").iterdir()) == []


def test_all_of_it_comes_back(session: Session, recovery: Recovery, tmp_path: Path) -> None:
    """Script and recording to each digit; the script knows its file, comments and all."""
    session.set("jaw_open", 0.25)
    session.set_key()
    edited = session.script
    session.set("jaw_open", 1.0 / 3.0)
    session.toggle_recording()
    session.set("jaw_open", 0.5)
    for _ in range(20):
        session.advance(STEP)
    recovery.save(session)
    assert found_by_next(tmp_path, session) is None  # its window still lives
    recovery.close()
    after = Session(session.scene, script_for(None, "face"))
    next_one = Recovery(tmp_path / "unsaved")
    next_one.find(after)
    assert next_one.found is not None
    assert next_one.found.summary == "the script smile.toml and a recording"
    next_one.accept_found(after)
    assert next_one.found is None and after.unsaved == "the script"
    assert after.script.at(0.2)["jaw_open"] == pytest.approx(0.5, abs=0.002)
    assert after.script.poses == edited.poses and after.file.path == tmp_path / "smile.toml"
    after.undo()  # the recording
    assert after.script == edited and after.script.preface == "# mine"
    assert after.file.path == tmp_path / "smile.toml" and after.file.objection == ""
    next_one.save(after)
    next_one.close()
    assert found_by_next(tmp_path, session) == Work(edited, tmp_path / "smile.toml")


def test_what_is_thrown_away_is_gone(session: Session, tmp_path: Path) -> None:
    """The latest is offered first, then the one before; damaged files are passed by."""
    folder = tmp_path / "unsaved"
    for value in (0.1, 0.2):
        one = Recovery(folder)
        session.set("jaw_open", value)
        one.save(session)
        one.close()
        new = [file for file in folder.iterdir() if not file.name.startswith("2020010")]
        for file in new:  # begun in one second, names are by chance
            file.rename(folder / f"2020010{round(10 * value)}{file.name[8:]}")
    (folder / "20270101-000000-abc.pose.toml").write_text("nonsense")
    (folder / "20270101-000000-abd.pose.toml").write_bytes(bytes(range(256)))
    next_one = Recovery(folder)
    next_one.find(session)
    assert next_one.found is not None and next_one.found.pose is not None
    assert next_one.found.pose.at(0.0)["jaw_open"] == 0.2
    next_one.discard_found(session)
    assert next_one.found is not None and next_one.found.pose is not None
    assert next_one.found.pose.at(0.0)["jaw_open"] == 0.1
    next_one.discard_found(session)
    assert next_one.found is None
    assert {file.name[:8] for file in folder.glob("*.toml")} == {"20270101"}


def test_only_what_fits_the_scene_is_offered(
    session: Session, recovery: Recovery, tmp_path: Path
) -> None:
    """A window with the plane leaves a face's pose to the next window with a face."""
    session.set("jaw_open", 0.4)
    recovery.save(session)
    recovery.close()
    plane = Session(PlaneScene(), script_for(None, "plane"))
    assert found_by_next(tmp_path, plane) is None
    assert found_by_next(tmp_path, session) is not None


def test_a_folder_that_takes_nothing_is_told_once(session: Session, clock: Clock) -> None:
    """The user is told that work is not safe, and works on."""
    recovery = Recovery(Path("/proc/none/unsaved"), clock)
    for value, words in ((0.4, "not kept safe: .*/proc/none"), (0.5, "")):
        session.set("jaw_open", value)
        recovery.watch(session)
        clock.now += QUIET
        if words:
            with pytest.raises(UserError, match=words):
                recovery.watch(session)
        else:
            recovery.watch(session)
    recovery.close()


# Real windows, real signals


def windows_process(folder: Path) -> subprocess.Popen[str]:
    """`risorius view`, with settings of its own; its window has been drawn."""
    process = subprocess.Popen(
        [sys.executable, "-m", "risorius", "view", "--size", "700x500"],
        cwd=ROOT, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "XDG_CONFIG_HOME": str(folder)}, start_new_session=True,
        # Tests that run behind an `&` or `nohup` have signals ignored, and pass that on.
        preexec_fn=lambda: [signal.signal(n, signal.SIG_DFL) for n in (1, 2, 15)],
    )  # fmt: skip
    search = ["xdotool", "search", "--sync", "--onlyvisible", "--name", "^Risorius: Expressions$"]
    subprocess.run(search, check=True, capture_output=True, timeout=60)
    return process


def press(*keys: str) -> None:
    """Keys, for the window under the mouse."""
    for key in keys:
        subprocess.run(["xdotool", "mousemove", "450", "200", "key", key], check=True)


@pytest.fixture
def at_work(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A window in which somebody has made a face by chance just now."""
    process = windows_process(tmp_path)
    try:
        title = ["xdotool", "search", "--onlyvisible", "--name", r"^Risorius: Expressions \*$"]

        def is_posed() -> bool:
            press("x")
            return bool(subprocess.run(title, capture_output=True, check=False).stdout)

        wait_for(is_posed)
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.slow
@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_a_window_that_is_told_to_stop_loses_nothing(
    at_work: subprocess.Popen[str], tmp_path: Path
) -> None:
    """What was done this moment is written before the end."""
    at_work.send_signal(signal.SIGHUP)
    assert at_work.wait(DEADLINE) == -signal.SIGHUP
    assert at_work.stderr is not None and at_work.stderr.read() == ""
    [pose] = [load_script(file) for file in tmp_path.glob("risorius/unsaved/*.pose.toml")]
    assert any(pose.at(0.0).values())


@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_a_window_that_crashed_is_recovered(at_work: subprocess.Popen[str], tmp_path: Path) -> None:
    """Killed some seconds after the last change; the next windows offer it until it is answered."""
    folder = tmp_path / "risorius"
    wait_for(lambda: stored_work(folder))
    at_work.kill()
    at_work.wait()
    [pose] = [load_script(file) for file in folder.glob("unsaved/*.pose.toml")]
    script = script_for(None, "face")
    for answer in ("Recover", "Throw away"):
        with Viewer(script, SIZE, settings_path=folder / "viewer.json") as viewer:
            settle(viewer)
            assert not viewer.session.unsaved
            click(viewer, f"offer: {answer}")
            assert "offer: Recover" not in viewer.gui.places
            if answer == "Recover":
                assert viewer.session.unsaved == "the pose" and stored_work(folder)
                values = viewer.session.values
                assert all(values[name] == value for name, value in pose.at(0.0).items())
    # The kill may have met a file on its way; its staging folder is swept by who writes there.
    left = [file for file in (folder / "unsaved").iterdir() if not file.name.startswith(PREFIX)]
    assert left == []


@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_work_that_is_given_up_is_not_offered(tmp_path: Path) -> None:
    """Closed without saving, after the question: nothing is left."""
    with Viewer(script_for(None, "face"), SIZE, settings_path=tmp_path / "viewer.json") as viewer:
        settle(viewer)
        viewer.session.set("jaw_open", 0.4)
        viewer.recovery.save(viewer.session)
        assert stored_work(tmp_path)
        xdotool(viewer, "key", "ctrl+q")
        click(viewer, "question: Close without saving")
        viewer.run()
    assert list((tmp_path / "unsaved").iterdir()) == []


@pytest.mark.slow
@pytest.mark.window
@NEEDS_A_SCREEN[1]
def test_recovering_asks_before_other_work_is_lost(session: Session, tmp_path: Path) -> None:
    """With something unsaved of its own, the window asks; going back keeps both."""
    recovery = Recovery(tmp_path / "unsaved")
    session.set("jaw_open", 0.4)
    recovery.save(session)
    recovery.close()
    script = script_for(None, "face")
    with Viewer(script, SIZE, settings_path=tmp_path / "viewer.json") as viewer:
        settle(viewer)
        viewer.session.set("AU12", 0.7)
        click(viewer, "offer: Recover")
        click(viewer, "question: Back")
        assert viewer.session.values["AU12"] == 0.7 and viewer.recovery.found is not None
        click(viewer, "offer: Recover")
        click(viewer, "question: Recover without saving")
        assert viewer.session.values["AU12"] == 0.0
        assert viewer.session.values["jaw_open"] == 0.4
    assert found_by_next(tmp_path, session) is not None  # it was not closed, but cut off
