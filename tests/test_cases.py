"""Typical files that were once refused or misread; they are in `tests/cases`.

Recordings are named by their content (`a` and `e`: units, flags and times; `d`: ways of writing
tables), heads by `b`. All face shapes are the built-in head, or made up.
"""

import tomllib
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from pytest import approx

from risorius import assets

from .app.command_line import succeeded

pytestmark = pytest.mark.slow

CASE_FOLDER = Path(__file__).parent / "cases"
SIZE = "160x120"


class Take:
    """A recording after `risorius convert`: the printed report, and the written script."""

    def __init__(self, name, folder, *options):
        output = folder / f"{Path(name).stem}.toml"
        self.report = succeeded("convert", CASE_FOLDER / name, "-o", output, *options)
        script = tomllib.loads(output.read_text("utf-8"))
        self.duration = script["duration"]
        self.tracks = {name: np.array(keys_of(track)) for name, track in script["tracks"].items()}

    def peak(self, name):
        """The largest value of a track, which is 0 for a missing one."""
        return float(self.tracks[name][:, 1].max()) if name in self.tracks else 0.0

    def reach(self, name):
        """The range of a track's values."""
        return float(np.ptp(self.tracks[name][:, 1])) if name in self.tracks else 0.0


def keys_of(track):
    """Times and values of a track, stored as a list of keys or as lines of two numbers."""
    if isinstance(track, str):
        rows = [line.split() for line in track.split("\n") if line.strip()]
        return [(float(row[0]), float(row[1])) for row in rows]
    assert isinstance(track, list)
    return [(key["time"], key["value"]) for key in track]


@pytest.mark.parametrize(
    ("name", "options", "seconds"),
    [
        ("a_json_head_rotation.json", (), 2.97),
        ("a_json_mediapipe_under_results.json", (), 2.97),
        ("a_json_names_once_weights.json", (), 2.97),
        ("d_all_cells_quoted.csv", (), 2.98),
        ("d_clock_iso.csv", (), 2.97),
        ("d_clock_iso.csv", ("--rate", "30"), 2.97),
        ("d_clock_milliseconds.csv", (), 2.97),
        ("d_clock_milliseconds.csv", ("--rate", "30"), 2.97),
        ("d_r_header_quoted_60fps.csv", (), 2.98),
        ("d_semicolon_decimal_comma.csv", (), 2.97),
        ("e_timecode60_rows30.csv", ("--rate", "30"), 3.97),
        ("e_timecode90.csv", (), 2.99),
        ("e_timecode90.csv", ("--rate", "90"), 2.99),
    ],
)
def test_a_take_lasts_as_long_as_its_file_says(name, options, seconds, tmp_path):
    """Clocks, timecode of any base and tables of any dialect keep their duration at any --rate."""
    assert Take(name, tmp_path, *options).duration == approx(seconds, abs=0.06)


def test_units_of_0_to_1_stay(tmp_path):
    """Action units in a file with values up to 1 are not divided by 5."""
    assert Take("a_openface_units_0_to_1.csv", tmp_path).peak("AU12") > 0.9


def test_shapes_in_percent_are_divided(tmp_path):
    """Shapes of 0 to 100 become shapes of 0 to 1, and no frame is lost."""
    take = Take("a_shapes_in_percent.json", tmp_path)
    assert 0.3 < take.reach("jawOpen") < 0.7
    assert "No face in" not in take.report


def test_intensities_count_before_detections(tmp_path):
    """AU12 follows its intensity column; its detection column of 0 or 1 is ignored."""
    values = Take("a_libreface_like.csv", tmp_path).tracks["AU12"][:, 1]
    assert np.abs(np.diff(values)).max() < 0.4


def test_the_head_turns_by_angles_beside_shapes(tmp_path):
    """Head angles beside shapes in JSON turn the head, or the report names them."""
    take = Take("a_json_head_rotation.json", tmp_path)
    turned = max(map(take.reach, ("head_yaw", "headYaw")))
    assert turned > 0.3 or "headRotation" in take.report


@pytest.mark.parametrize("name", ["e_lost_frames_zero.json", "e_lost_frames_zero_livelink.csv"])
def test_frames_without_a_face_are_left_out(name, tmp_path):
    """Rows of zeros without a face do not move the face, and do not count for calibration."""
    take = Take(name, tmp_path)
    control = Take("e_lost_frames_control.json", tmp_path)
    assert "40 of 150" in take.report
    assert take.peak("browDownLeft") == approx(control.peak("browDownLeft"), abs=0.03)
    assert take.peak("browDownLeft") < 0.1


LANDMARKS = CASE_FOLDER / "own_landmarks.json"  # vertex indices
POINTS = CASE_FOLDER / "own_landmark_points.json"  # points [m]


def picture_of(head, landmarks, output):
    """The picture of a head from a file at rest, as `capture` draws it, shape (H, W, 3)."""
    succeeded(
        *("capture", "--head", CASE_FOLDER / head, "--landmarks", landmarks, "--set", "joy=0"),
        *("-o", output, "--size", SIZE, "--background", "white", "--quiet"),
    )
    return np.asarray(PIL.Image.open(output).convert("RGB"), float)


@pytest.mark.parametrize(
    ("head", "landmarks"),
    [
        ("b_hair_card_two_sided.obj", LANDMARKS),
        ("b_mouth_open_a_little.obj", LANDMARKS),
        ("b_triangle_strips.ply", LANDMARKS),
        ("b_mask_front.obj", CASE_FOLDER / "b_mask_front.json"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.stem,
)
def test_a_head_of_a_file_is_drawn(head, landmarks, tmp_path):
    """Heads with hair cards, an open mouth, strips or covering triangles are drawn."""
    picture = picture_of(head, landmarks, tmp_path / "head.png")
    middle = picture[40:80, 60:100]
    assert middle.mean() < 230.0


def test_glb_is_read_as_its_accessors_say(tmp_path):
    """One mesh, stored normalized, transformed and quantized, has nearly the same picture."""
    pictures = [
        picture_of(f"b_glb_{kind}.glb", POINTS, tmp_path / f"{kind}.png")
        for kind in ("texcoord_u16_normalized", "texture_transform", "quantized_positions")
    ]
    for picture in pictures[1:]:
        assert np.abs(picture - pictures[0]).mean() < 2.0
    assert pictures[0][40:80, 60:100].mean() < 230.0


def test_colours_of_vertices_are_linear():
    """Linear 16-bit vertex colours 0.2 0.5 0.9 become the blue (124, 188, 243)."""
    mesh = assets.read_mesh(CASE_FOLDER / "b_glb_colours_u16.glb")
    assert np.abs(mesh.colours.reshape(-1, 3) - np.array([124.0, 188.0, 243.0])).max() < 2.0


def test_a_material_with_tabs_has_its_picture(tmp_path):
    """Tabs separate words in an MTL file: squares of green and yellow are drawn."""
    picture = picture_of("mtl_tab/head.obj", LANDMARKS, tmp_path / "head.png")
    middle = picture[40:80, 60:100]
    assert (middle[..., 1] > middle[..., 2] + 40.0).mean() > 0.5
