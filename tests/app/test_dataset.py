"""`risorius dataset`: a complete set of samples, with the same bytes however it is made."""

import csv
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_allclose
from pytest import approx
from scipy.ndimage import binary_dilation, binary_erosion

from risorius import render
from risorius.app.dataset.folder import UNFINISHED_SUFFIX, SetFolder
from risorius.app.dataset.labels import action_units, labels_of_face
from risorius.app.dataset.request import request_of
from risorius.app.dataset.sampling import draw
from risorius.app.dataset.studio import Studio, _posed
from risorius.app.dataset.table import load_table
from risorius.assets import Segment

from .command_line import refusal, risorius
from .without_workers import in_this_process

SAMPLE_COUNT = 4
SEED = 11
SIZE = (80, 64)
PASSES = ("depth", "normal", "segmentation")
FILE_ENDS = ("_ldmks.txt", "_seg.png", ".exr", ".json", ".png")
DATASET_OPTIONS = (
    "--seed", str(SEED), "--size", "x".join(map(str, SIZE)), "--passes", ",".join(PASSES),
    "--quiet",
)  # fmt: skip


def run(folder, *options, count=SAMPLE_COUNT):
    """Run the command in this process, without workers."""
    with in_this_process():
        return run_with_workers(folder, *options, count=count)


def run_with_workers(folder, *options, count=SAMPLE_COUNT):
    """Run the command in this process; its workers are other processes."""
    return risorius("dataset", "--count", count, "-o", folder, *DATASET_OPTIONS, *options)


def content(folder):
    """The bytes of all files in a folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A set made by two processes."""
    folder = tmp_path_factory.mktemp("set") / "made"
    result = run_with_workers(folder, "--jobs", "2")
    assert result.exit_code == 0, result.output
    assert result.output.startswith(f"{folder}: {SAMPLE_COUNT} samples, {SAMPLE_COUNT} of them new")
    return folder


@pytest.fixture(scope="module")
def samples(made: Path) -> list[dict[str, Any]]:
    """The labels of all samples."""
    return [json.loads((made / f"{k:06d}.json").read_text("utf-8")) for k in range(SAMPLE_COUNT)]


def test_a_set_has_these_files_and_nothing_else(made, samples):
    """A set has exactly these files; no picture and no face occurs twice."""
    message = {"README.md", "dataset.json", "index.csv"}
    assert set(content(made)) == message | {
        f"{k:06d}{end}" for k in range(SAMPLE_COUNT) for end in FILE_ENDS
    }
    pictures = {path.read_bytes() for path in made.glob("[0-9]*[0-9].png")}
    faces = {str(sample["controls"]) for sample in samples}
    assert len(pictures) == SAMPLE_COUNT
    assert len(faces) == SAMPLE_COUNT


def test_a_sample_is_the_same_alone_and_after_others(made, tmp_path):
    """A sample has the same bytes in another process and in another order."""
    request = request_of(made, seed=SEED, size=SIZE, passes=PASSES)
    studio = Studio(request)
    for index in (3, 0):
        studio.shoot(index).save(tmp_path / f"{index:06d}.png")
        for name in [f"{index:06d}{end}" for end in FILE_ENDS if end != ".json"]:
            assert (tmp_path / name).read_bytes() == (made / name).read_bytes(), name
        alone, labels = (
            json.loads((folder / f"{index:06d}.json").read_text("utf-8"))
            for folder in (tmp_path, made)
        )
        assert labels == alone | {"files": labels["files"]}


def test_a_damaged_sample_is_made_anew(made, tmp_path):
    """Samples with empty labels or a missing picture are made anew, with the same bytes."""
    folder = tmp_path / "damaged"
    shutil.copytree(made, folder)
    (folder / "000000.json").write_bytes(b"")
    (folder / "000002.png").unlink()
    (folder / UNFINISHED_SUFFIX / "0000034711").mkdir(parents=True)
    assert "2 of them new" in run(folder, "--resume").output
    assert content(folder) == content(made)
    assert "0 of them new" in run(folder, "--resume").output


def test_a_sample_counts_when_all_of_its_files_are_whole(made, tmp_path):
    """A sample is not counted as complete if something else has the name of one of its files."""
    labels = (made / "000001.json").read_bytes()
    picture = (made / "000001.png").read_bytes()
    instead = [
        *((f"000001{end}", None) for end in FILE_ENDS),
        *((f"000001{end}", b"") for end in FILE_ENDS),
        ("000001.json", labels[:-1][: len(labels) // 2]),
        ("000001.json", labels[:-2]),
        ("000001.json", b"\xff\xfe\x00"),
        ("000001.json", b"{}"),
        ("000001.json", b"[1]"),
        ("000001.json", b"[" * 100_000),
        ("000001.json", b'{"index": 1, "files": {}}'),
        ("000001.json", b'{"index": 1, "files": {"000001.png": 3, "\\u0000": 1}}'),
        ("000001.json", (made / "000002.json").read_bytes()),
        ("000001.png", picture[:-1]),
        ("000001.png", picture[: len(picture) // 2]),
        ("000001.png", picture + b"more"),
    ]
    folder = tmp_path / "damaged"
    shutil.copytree(made, folder)
    held = SetFolder(folder)
    assert all(held.has(index) for index in range(SAMPLE_COUNT))
    for name, damaged in instead:
        (folder / name).unlink()
        if damaged is not None:
            (folder / name).write_bytes(damaged)
        missing = [index for index in range(SAMPLE_COUNT) if not held.has(index)]
        assert missing == [1], name
        shutil.copyfile(made / name, folder / name)
    (folder / "000001_seg.png").unlink()
    (folder / "000001_seg.png").mkdir()
    assert not held.has(1)


@pytest.mark.slow
def test_a_set_can_be_made_longer(made, tmp_path):
    """A set made longer equals one made at once; a set cannot be made shorter."""
    folder = tmp_path / "short"
    run(folder, count=2)
    assert "2 of them new" in run(folder, "--resume").output
    assert content(folder) == content(made)
    message = refusal(run(folder, "--resume", count=3))
    assert "has sample 3 already; give --count 4 or more" in message


def test_other_folders_are_left_alone(made, tmp_path):
    """A folder with other content is reported in one line, and every file stays."""
    before = content(made)
    other = tmp_path / "other"
    other.mkdir()
    (other / "mine.txt").write_text("mine", "utf-8")
    for folder, options, message in (
        (made, (), "holds a data set; add --resume"),
        (made, ("--resume", "--seed", "12"), "was begun with seed 11, not 12"),
        (made, ("--resume", "--background", "red"), "was begun with background null, not [1.0"),
        (made, ("--resume", "--passes", "depth"), "was begun with passes"),
        (made, ("--resume", "--refiner", "none"), 'was begun with refiner null, not "none"'),
        (other, ("--resume",), "is not empty, and no data set"),
    ):
        assert message in refusal(run(folder, *options))
    assert content(made) == before
    assert [path.name for path in other.iterdir()] == ["mine.txt"]


@pytest.mark.slow
def test_a_set_begins_anywhere(made, tmp_path):
    """A set that begins later has the same samples, and can be completed from 0 on."""
    folder = tmp_path / "part"
    assert run(folder, "--first", 2, count=2).exit_code == 0
    for end in FILE_ENDS:
        assert not (folder / f"000001{end}").exists()
        name = f"000003{end}"
        assert (folder / name).read_bytes() == (made / name).read_bytes()
    assert f"--count 2 --first 2 --seed {SEED}" in (folder / "README.md").read_text("utf-8")
    message = refusal(run(folder, "--resume", "--first", 3, count=2))
    assert "has sample 2 already; give --first 2 and --count 3 or more" in message
    assert "2 of them new" in run(folder, "--resume").output
    assert content(folder) == content(made)


def test_a_set_ends_within_six_digits(tmp_path):
    message = refusal(run(tmp_path, "--first", 999_998, count=3))
    assert "ends at sample 1000000, the last can be 999999; give --count 2 or less" in message


def test_jobs_and_scheduler_exclude_each_other(tmp_path):
    """Both options are refused together, because a cluster has a fixed number of workers."""
    message = refusal(run(tmp_path, "--jobs", 2, "--scheduler", "tcp://a:1"))
    assert "--jobs and --scheduler exclude each other" in message


def test_two_cannot_make_one_set(made):
    request = request_of(made, seed=SEED, size=SIZE, passes=PASSES)
    with SetFolder(made).opened(request.options(), resume=True):
        message = refusal(run(made, "--resume"))
    assert "another process is making this set" in message


def test_labels_agree_with_each_other(made, samples):
    """Points in space, camera, points in the picture, and the landmark file agree."""
    for sample in samples:
        camera = sample["camera"]
        landmarks = sample["landmarks"]
        points = np.array(landmarks["points"])
        seen = points @ np.array(camera["R"]).T + camera["t"]
        pixels = seen @ np.array(camera["K"]).T
        assert_allclose(pixels[:, :2] / pixels[:, 2:], landmarks["pixels"], atol=1e-3)
        rows = np.loadtxt(made / f"{sample['id']}_ldmks.txt")
        assert rows.shape == (70, 2)
        assert_allclose(rows, landmarks["pixels"], atol=1e-3)
        units = sample["action_units"]
        for name, value in sample["controls"].items():
            if name in units:
                assert units[name] == approx(value, abs=1e-4)
        assert len(sample["arkit"]) == 52
        x, y, width, height = sample["face_box"]
        assert 0 <= x < x + width <= SIZE[0]
        assert 0 <= y < y + height <= SIZE[1]


def test_the_index_has_a_row_for_each_sample(made, samples):
    with (made / "index.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == [sample["id"] for sample in samples]
    for row, sample in zip(rows, samples, strict=True):
        for name, value in sample["action_units"].items():
            assert float(row[name]) == value
        assert float(row["head_yaw"]) == sample["head"]["yaw"]


def test_the_card_lists_the_contents_of_the_set(made, samples):
    card = (made / "README.md").read_text("utf-8")
    (command,) = re.findall(r"^    risorius (.* -o FOLDER)$", card, re.MULTILINE)
    assert command.startswith(f"dataset --count {SAMPLE_COUNT} --seed {SEED}")
    for file in ("index.csv", "dataset.json"):
        assert f"`{file}`" in card
    for unit in ("AU12", "AU25"):
        is_active = [sample["action_units"][unit] >= 0.05 for sample in samples]
        share = float(np.mean(is_active))
        assert (f"| {unit} | {share:.1%} |" in card) == (share > 0)
    assert "{" not in card


@pytest.mark.slow
def test_pictures_stand_behind_faces(tmp_path):
    """Outside all classes the picture has exactly the chosen background colour."""
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    PIL.Image.new("RGB", (100, 50), (10, 200, 30)).save(pictures / "green.png")
    behind = {}
    for name, background in (("colour", "#0ac81e"), ("picture", str(pictures))):
        request = request_of(
            tmp_path, seed=3, size=(96, 96), passes=("segmentation",), background=background
        )
        shot = Studio(request).shoot(0)
        is_behind = shot.known.images["segmentation"] == 0
        behind[name] = shot.image
        is_inner = binary_erosion(is_behind)  # without pixels beside another class
        # A single strand may be thinner than the pixels of its class.
        is_hair = shot.known.images["segmentation"] == Segment.HAIR
        is_inner &= ~binary_dilation(is_hair, iterations=3)
        assert is_inner.mean() > 0.2
        colours = shot.image[is_inner].astype(int)
        off = np.abs(colours - (10, 200, 30)).max(axis=1)
        assert (off > 1).mean() < 0.02  # the rim of hair on the far side
    apart = np.abs(behind["colour"].astype(int) - behind["picture"]).max(axis=2)
    assert (apart > 2).sum() <= 3  # where many layers of hair, each rounded, are above each other
    assert apart.max() <= 4


@pytest.mark.slow
@pytest.mark.parametrize("unit", load_table(None).units)
def test_landmarks_move_further_the_more_of_a_unit(face, unit):
    """With each step of a unit's label, the farthest landmark moves on by at least a tenth."""
    rest = face.rest_positions[face.landmarks]
    moved = []
    for value in (0.25, 0.5, 0.75, 1.0):
        face.reset()
        face.pose({unit: value})
        face.step(1.0)
        assert action_units(face)[unit] == approx(value, abs=1e-4)
        away = np.linalg.norm(face.positions[face.landmarks] - rest, axis=1)
        moved.append(float(away.max()))
    assert moved[0] > 0.05
    assert (np.diff(moved) > 0.1 * moved[-1]).all()


def apertures_of(face, pose):
    """The labelled apertures of mouth and eyes in a pose."""
    face.reset()
    face.pose(pose)
    face.step(1.0)
    camera = render.OrbitCamera.framing(face.framing.framed)
    labels = labels_of_face(face, camera, (64, 48), np.ones((48, 64)))
    return labels["apertures"]


@pytest.mark.parametrize("shut", ["AU17 AU15 AU4", "AU24", "AU28", "AU12", "AU43 AU6", "AU43 AU51"])
def test_shut_lips_and_lids_have_no_aperture(face, shut):
    """Rolled lips and squeezed lids have aperture 0, although landmarks are 1 to 4 mm apart."""
    found = apertures_of(face, dict.fromkeys(shut.split(), 1.0))
    assert found.pop("mouth") < 0.1
    lids_are_shut = {value < 0.1 for value in found.values()}
    assert lids_are_shut == {"AU43" in shut}


def test_apertures_grow_with_the_opening(face):
    """Apertures grow in proportion to the opening, for each eye and any turn of the head."""
    parted = [apertures_of(face, {"AU25": value})["mouth"] for value in (0.25, 0.5, 0.75, 1.0)]
    assert parted[0] < 2.0  # FACS: in 25A, less than 2 mm
    assert np.diff(parted) == approx(2.0, abs=0.4)
    turned = apertures_of(face, {"AU25": 1.0, "AU43_left": 0.5, "AU51": 1.0, "AU54": 1.0})
    assert turned["mouth"] == approx(parted[-1], abs=0.1)
    assert turned["eye_left"] == approx(0.5 * turned["eye_right"], abs=0.5)
    assert apertures_of(face, {"AU27": 1.0})["mouth"] > 20.0


def test_an_open_smile_bares_teeth(face):
    """Parted lips of a full smile show at least 4 mm of the teeth, which they once nearly hid."""
    assert apertures_of(face, dict.fromkeys(("AU6", "AU12", "AU25"), 1.0))["mouth"] > 4.0


@pytest.mark.parametrize("index", [0, 2, 10])
def test_a_face_is_photographed_at_rest(face, index):
    """A second later, no vertex of a posed face has moved by more than 0.002 mm."""
    _posed(face, draw(load_table(None), 3, index), SIZE)
    pictured = face.positions.copy()
    face.step(1.0)
    assert np.abs(face.positions - pictured).max() < 0.002


def test_speech_is_reported_in_units(face):
    """Labels give speech as action units; a unit that was set keeps its value."""
    face.reset()
    face.pose({"viseme_SS": 0.5, "AU1_left": 0.3})
    units = {name: value for name, value in action_units(face).items() if value > 0.01}
    assert units.pop("AU1") == units.pop("AU1_left") == approx(0.3, abs=1e-4)
    shares = {"AU20": 0.35, "AU12": 0.15, "AU25": 0.4, "AU26": 0.06}
    for name, share in shares.items():
        assert units[name] == approx(0.5 * share, abs=1e-3)
