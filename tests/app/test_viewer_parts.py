"""What the viewer is made of, without a window: session, recorder, settings, clock, skin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from viewer import STOPS

from risorius.app.controls.mirror import mirrored
from risorius.app.scenes import FaceScene
from risorius.app.viewer.panels.rows import rows_of, search_rows
from risorius.app.viewer.picture import skin
from risorius.app.viewer.picture.painter import FULL, LEVELS, PATIENCE, LevelOfDetail
from risorius.app.viewer.session.physics import EARLIEST, MOST_STEPS, STEP, Clock
from risorius.app.viewer.session.session import Session

from risorius import render  # isort: skip - after the viewer, see app/viewer/gui.py

SMILE = "zygomaticus_major"
STEPS = 90


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
    assert rows_of(names, values, linked=True)[0].names == ("AU12", "AU12_right", "AU12_left")
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
    ray = skin.Ray.through(camera, viewport, place)
    point = skin.skin_under(ray, scene.rest_positions, scene.faces)
    assert point is not None and np.linalg.norm(point - tip) < 0.5
    missed = skin.Ray.through(camera, viewport, (31, 21))
    assert skin.skin_under(missed, scene.rest_positions, scene.faces) is None


def test_no_ray_slips_between_triangles(scene: FaceScene) -> None:
    """At vertices and in the middle of edges, as clicks on the mid-line are, seen from anywhere."""
    points, faces = scene.rest_positions, scene.faces
    edges = points[faces[:, :2]].mean(axis=1)
    middle = scene.rest_positions.mean(axis=0)
    for target in (*points[::7], *points[points[:, 0] == 0.0], *edges[::11]):
        outward = target - middle
        for sight in (outward, outward * [0.0, 1.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.3, 1.0]):
            sight = np.asarray(sight) / np.linalg.norm(sight)
            ray = skin.Ray(target + 400.0 * sight, -sight)
            point = skin.skin_under(ray, points, faces, from_outside=False)
            assert point is not None
            assert np.linalg.norm(point - ray.origin) < 400.0 + 1e-6


def test_the_page_shows_every_picture_of_the_tour() -> None:
    """docs/viewer.md and the program that draws its pictures agree, and the files are there."""
    page = Path("docs/viewer.md").read_text(encoding="utf-8")
    for name in STOPS:
        image = Path("docs/pictures") / f"{name}.webp"
        assert f"pictures/{name}.webp" in page
        assert 10_000 < image.stat().st_size < 450_000


def test_what_a_live_face_sends_is_stepped_at_once_and_time_keeps_its_pace() -> None:
    """At whatever phase frames come: one step each, and never more than one ahead of time."""
    for phase in np.linspace(0.0, 1.0, 11):
        clock = Clock()
        clock.steps(phase * STEP)
        steps = [clock.steps(STEP, EARLIEST) for _ in range(100)]
        assert min(steps) >= 1 and abs(sum(steps) - 100) <= 1
    clock = Clock()
    assert sum(clock.steps(STEP / 4, EARLIEST) for _ in range(100)) <= 26
