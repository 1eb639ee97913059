"""What the viewer is made of, without a window: session, recorder, settings, clock, picking."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from viewer import STOPS

from risorius.app.controls.mirror import mirrored
from risorius.app.errors import UserError
from risorius.app.performances import script_for
from risorius.app.scenes import FaceScene
from risorius.app.script import (
    load_script,
)
from risorius.app.viewer.overlays import LINES, overlays_of
from risorius.app.viewer.panels.rows import rows_of, search_rows
from risorius.app.viewer.picture import picking
from risorius.app.viewer.picture.painter import FULL, LEVELS, PATIENCE, LevelOfDetail
from risorius.app.viewer.session.history import MOST_GROWTH, History
from risorius.app.viewer.session.physics import EARLIEST, MOST_STEPS, STEP, Clock
from risorius.app.viewer.session.session import Session
from risorius.assets.fitting import fit_head
from tests.heads import stranger

from risorius import render  # isort: skip - after the viewer, see app/viewer/gui.py

SMILE = "zygomaticus_major"
STEPS = 90


@pytest.fixture
def session(scene: FaceScene) -> Session:
    """A session that begins with the neutral face."""
    scene.reset()
    return Session(scene, script_for(None, "face"))


def run(session: Session, steps: int = STEPS) -> None:
    """Let so many steps of time pass."""
    for _ in range(steps):
        session.advance(STEP)


def test_a_recording_plays_back_to_the_same_positions(session: Session, tmp_path: Path) -> None:
    """Record, save, load, replay: every vertex ends where it was, to a hundredth of a mm."""
    session.begin_script()
    session.edit(replace(session.script, duration=1.0))
    session.toggle_recording()
    run(session, 30)
    for step in range(60):
        session.set("jaw_open", step / 60.0)
        session.advance(STEP)
    session.set(f"{SMILE}_left", 0.8)
    run(session, 60)
    wanted = session.scene.positions.copy()
    assert np.abs(wanted - session.scene.rest_positions).max() > 10.0
    session.toggle_recording()
    assert "the script" in session.unsaved
    session.save_script(tmp_path / "take.toml")
    assert not session.unsaved
    session.neutral()
    run(session)
    session.open(load_script(tmp_path / "take.toml"))
    session.toggle_playing()
    while session.is_playing:
        session.advance(STEP)
    assert np.abs(session.scene.positions - wanted).max() < 0.01


@pytest.mark.slow
def test_a_recording_beside_a_sound_is_in_step_with_it(session: Session, tmp_path: Path) -> None:
    """The script plays meanwhile, and what is heard at a time was recorded at that time."""
    played = replace(session.script, sound=tmp_path / "sound.wav")
    session.edit(played)
    session.seek(0.5)
    session.toggle_recording()
    assert session.is_playing
    run(session, 30)  # to 1 s
    session.toggle_playing()
    run(session, 30)  # paused
    session.toggle_playing()
    session.set("jaw_open", 0.8)
    run(session, 30)  # to 1.5 s
    at, session.is_looping = session.time, True
    while session.time >= at:
        session.advance(STEP)
    session.set("jaw_open", 0.1)
    run(session, 30)  # heard before
    whole = session.script.duration
    session.toggle_recording()
    script = session.script
    assert script.sound == tmp_path / "sound.wav"
    assert script.duration == pytest.approx(whole, abs=0.02)
    for time in (0.6, 0.97):
        heard = {**dict.fromkeys(script.tracks, 0.0), **played.at(time)}
        assert any(heard.values()) and script.at(time) == pytest.approx(heard, abs=0.05)
    assert script.at(1.05)["jaw_open"] == script.at(whole)["jaw_open"] == 0.8


def test_an_empty_recording_is_refused(session: Session) -> None:
    """Where nothing moved there is nothing to keep, and the script stays."""
    script = session.script
    session.toggle_recording()
    run(session, 5)
    with pytest.raises(UserError, match="no control moved"):
        session.toggle_recording()
    assert session.script is script and not session.is_recording


def test_history_does_not_fill_the_memory() -> None:
    """The oldest states go where many share nothing with the one before; one undo stays."""
    history = History(0, lambda before, after: MOST_GROWTH // 3)
    for state in range(1, 300):
        history.note(state)
    assert [history.go(history.place - 1) for _ in range(5)] == [298, 297, 296, 296, 296]
    history = History(0, lambda before, after: 2 * MOST_GROWTH)
    history.note(1)
    history.note(2)
    assert [history.go(place) for place in (0, -1, 1)] == [1, 1, 2]


def test_mirror_and_links(session: Session) -> None:
    """Left becomes right, sideways turns round; a linked slider moves both sides."""
    session.set(f"{SMILE}_left", 0.7)
    session.set("jaw_sideways", 0.4)
    session.mirror()
    assert session.values[f"{SMILE}_right"] == 0.7 and not session.values[f"{SMILE}_left"]
    assert session.values["jaw_sideways"] == -0.4
    session.set(f"{SMILE}_left", 5.0, linked=True)
    assert session.values[f"{SMILE}_left"] == session.values[f"{SMILE}_right"] == 1.0
    assert mirrored(mirrored(session.values)) == session.values


def test_random_faces_are_symmetric_and_within_limits(session: Session) -> None:
    """A random face moves some muscles, both sides alike, and can be undone."""
    session.randomise(np.random.default_rng(3))
    moved = {name: value for name, value in session.values.items() if value}
    assert moved == mirrored(moved) and 4 < len(moved) < 60
    session.undo()
    assert not any(session.values.values())


def test_rows_join_sides() -> None:
    """Twins share a row; a control for both sides stands for them unless they differ."""
    names = ["AU12", "AU12_left", "AU12_right", "lid_left", "lid_right", "procerus"]
    values = dict.fromkeys(names, 0.0)
    linked = {row.label: row.names for row in rows_of(names, values, linked=True)}
    assert linked["AU12"] == ("AU12",) and linked["lid"] == ("lid_left",)
    apart = {row.label: row.names for row in rows_of(names, values, linked=False)}
    assert apart["AU12"] == ("AU12_right", "AU12_left") and apart["procerus"] == ("procerus",)
    values["AU12_left"] = 0.5
    assert rows_of(names, values, linked=True)[0].names == ("AU12_right", "AU12_left")
    values["AU12"] = 0.5
    assert rows_of(names, values, linked=True)[0].names == ("AU12_right", "AU12_left")
    rows = rows_of(names, values, linked=True)
    assert [
        row.label for row in search_rows(rows, "smile au", group="", actions={"AU12": "Smile"})
    ] == ["AU12"]


def test_clock_steps_at_its_own_rate() -> None:
    """Steps are as many as the time wants, whatever the frames; a stall is mostly forgotten."""
    for frame in (1.0 / 144.0, 1.0 / 60.0, 1.0 / 20.0):
        clock = Clock()
        steps = sum(clock.steps(frame) for _ in range(round(2.0 / frame)))
        assert abs(steps - 2.0 / STEP) <= 1
    clock = Clock()
    assert clock.steps(30.0) == MOST_STEPS
    assert clock.steps(STEP) == 1


def test_detail_falls_once_and_does_not_flicker() -> None:
    """Slow frames lower the level; fast ones raise it by one, and only as a motion begins."""
    chosen = LevelOfDetail(is_software=False)
    assert chosen.detail == FULL
    for _ in range(2 * PATIENCE):
        chosen.note(0.08)
    assert chosen.level == 2
    for _ in range(100):
        chosen.note(0.01)
    assert chosen.level == 2
    chosen.begin_motion()
    assert chosen.level == 1
    for _ in range(100):
        chosen.note(0.08)
    assert chosen.detail == LEVELS[-1]


@pytest.mark.parametrize("is_orthographic", [False, True])
def test_the_point_under_the_mouse(scene: FaceScene, is_orthographic: bool) -> None:
    """The ray through the tip of the nose meets it; one through a corner meets nothing."""
    camera = render.OrbitCamera.framing(scene.rest_positions)
    camera.is_orthographic = is_orthographic
    viewport = (30, 20, 400, 500)
    tip = scene.rest_positions[scene.rest_positions[:, 2].argmax()]
    clip = np.append(tip, 1.0) @ np.asarray(
        camera.view_matrix() @ camera.projection_matrix(400 / 500)
    )
    x, y = clip[:2] / clip[3]
    place = 30 + 200 * (x + 1), 20 + 250 * (y + 1)
    ray = picking.Ray.through(camera, viewport, place)
    point = picking.skin_under(ray, scene.rest_positions, scene.faces)
    assert point is not None and np.linalg.norm(point - tip) < 0.5
    missed = picking.Ray.through(camera, viewport, (31, 21))
    assert picking.skin_under(missed, scene.rest_positions, scene.faces) is None


def test_no_ray_slips_between_triangles(scene: FaceScene) -> None:
    """At vertices and in the middle of edges, as clicks on the mid-line are, seen from anywhere."""
    points, faces = scene.rest_positions, scene.faces
    edges = points[faces[:, :2]].mean(axis=1)
    middle = scene.rest_positions.mean(axis=0)
    for target in (*points[::7], *points[points[:, 0] == 0.0], *edges[::11]):
        outward = target - middle
        for sight in (outward, outward * [0.0, 1.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.3, 1.0]):
            sight = np.asarray(sight) / np.linalg.norm(sight)
            ray = picking.Ray(target + 400.0 * sight, -sight)
            point = picking.skin_under(ray, points, faces, from_outside=False)
            assert point is not None
            assert np.linalg.norm(point - ray.origin) < 400.0 + 1e-6


def test_the_page_shows_every_picture_of_the_tour() -> None:
    """docs/viewer.md and the program that draws its pictures agree, and the files are there."""
    page = Path("docs/viewer.md").read_text(encoding="utf-8")
    for name in STOPS:
        image = Path("docs/pictures") / f"{name}.webp"
        assert f"pictures/{name}.webp" in page
        assert 10_000 < image.stat().st_size < 450_000


@pytest.mark.slow
def test_a_head_that_somebody_brings_has_every_overlay(tmp_path: Path) -> None:
    """Springs and landmarks of a fitted head are lines; test_anatomy.py has the solids."""
    fitted = FaceScene(fit_head(*stranger().write(tmp_path)))
    assert overlays_of(fitted) == ("muscles", "springs", "skull", "landmarks")
    edges, camera = fitted.faces[:, :2], render.OrbitCamera.framing(fitted.rest_positions)
    for lines in LINES.values():
        assert np.isfinite(np.array(lines(fitted, edges, camera).polylines)).all()


def test_what_a_live_face_sends_is_stepped_at_once_and_time_keeps_its_pace() -> None:
    """At whatever phase frames come: one step each, and never more than one ahead of time."""
    for phase in np.linspace(0.0, 1.0, 11):
        clock = Clock()
        clock.steps(phase * STEP)
        steps = [clock.steps(STEP, EARLIEST) for _ in range(100)]
        assert min(steps) >= 1 and abs(sum(steps) - 100) <= 1
    clock = Clock()
    assert sum(clock.steps(STEP / 4, EARLIEST) for _ in range(100)) <= 26


def test_the_face_that_is_led_becomes_keys_poses_and_recordings(
    session: Session, tmp_path: Path
) -> None:
    """They take what is seen, not what sliders say beneath it."""
    session.live_override.take({"jaw_open": 0.5}, 1.0)
    session.save_pose(tmp_path / "pose.toml")
    assert load_script(tmp_path / "pose.toml").at(0.0)["jaw_open"] == 0.5
    session.begin_script()
    session.set_key()
    assert session.script.at(0.0)["jaw_open"] == 0.5
    session.neutral()
    session.toggle_recording()
    for step in range(30):
        session.live_override.take({"jaw_open": step / 30.0}, 1.0)
        session.advance(STEP)
    session.toggle_recording()
    assert session.script.at(0.25)["jaw_open"] == pytest.approx(0.5, abs=0.05)
