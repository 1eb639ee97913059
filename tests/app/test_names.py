"""File names that are not UTF-8, and outputs in place of symbolic links."""

import csv
import json
import os
import shutil
import sys
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from risorius.app.errors import UserError
from risorius.app.files import check_apart, check_file, save_text
from risorius.app.pictures import save_png
from risorius.app.script import Pose, Script
from risorius.app.script.script_file import load_script, save_script, script_text
from risorius.app.text import as_text, in_one_line

from .command_line import refusal, risorius, succeeded
from .recording_files import timecodes, written

RAW_NAME = "l\udce4cheln"  # "lächeln" in Latin-1, as in an old archive
SHOWN_NAME = r"l\xe4cheln"
SMALL_OPTIONS = ("--size", "64x64")
needs_bytes = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="names are bytes on Linux alone"
)


def take(path):
    """A short recording."""
    times = timecodes(range(12))
    return written(path, {"Timecode": times, "jawOpen": np.linspace(0.0, 0.8, 12)})


def pose(path, *more):
    """A script of a pose held for a fifth of a second; more: lines at its beginning."""
    lines = (*more, "duration = 0.2", "[[pose]]", "time = 0.0", "jaw_open = 0.5")
    path.write_text("\n".join(lines), "utf-8")
    return path


def test_names_as_text():
    """Bytes that are not UTF-8 are escaped; all other characters stay."""
    assert (
        as_text(Path(f"/a/{RAW_NAME}.csv"))
        == f"/a/{SHOWN_NAME}.csv"
        == in_one_line(f"/a/{RAW_NAME}.csv")
    )
    assert as_text("schöner & größer \\ 笑") == "schöner & größer \\ 笑"
    as_text("\ud800 alone").encode()


@needs_bytes
def test_a_recording_with_such_a_name_becomes_a_script(tmp_path):
    """A recording with such a name becomes a script with a title and preface in UTF-8.

    A script can also be written under such a name, and read again.
    """
    recording = take(tmp_path / f"{RAW_NAME}.csv")
    script = tmp_path / f"{RAW_NAME}.toml"
    output = succeeded("convert", recording, "-o", script)
    assert f"{SHOWN_NAME}.toml: " in output
    text = script.read_text("utf-8")
    assert tomllib.loads(text)["title"] == SHOWN_NAME
    assert text.startswith(f"# Made of {SHOWN_NAME}.csv")
    assert load_script(script).title == SHOWN_NAME
    succeeded("convert", recording, "-o", tmp_path / "plain.toml")
    assert (tmp_path / "plain.toml").read_text("utf-8") == text


@needs_bytes
def test_a_script_names_no_such_sound(tmp_path):
    """A script cannot name such a sound, because TOML is UTF-8.

    One line names the file to rename.
    """
    script = Script("a", 1.0, source="a", poses=(Pose(0.0),), sound=tmp_path / f"{RAW_NAME}.wav")
    with pytest.raises(UserError, match=r"l\\xe4cheln.wav: a script cannot name .* rename it"):
        save_script(tmp_path / "a.toml", script)
    assert list(tmp_path.iterdir()) == []
    untitled = Script(
        RAW_NAME, 1.0, source="a", camera=RAW_NAME, poses=(Pose(0.0),), preface=f"# {RAW_NAME}"
    )
    assert tomllib.loads(script_text(untitled))["camera"] == SHOWN_NAME


@needs_bytes
@pytest.mark.parametrize("end", [".pc2", ".usdz", ".glb", ".vtkhdf", ".npz", ".csv"])
@pytest.mark.parametrize("where", ["name", pytest.param("folder", marks=pytest.mark.slow)])
def test_motion_with_such_a_name_is_exported(where, end, tmp_path):
    """Motion is exported to files and folders, and from sources, with such names."""
    script = pose(tmp_path / f"{RAW_NAME}.toml")
    folder = tmp_path / (RAW_NAME if where == "folder" else "folder")
    target = folder / f"{'plain' if where == 'folder' else RAW_NAME}{end}"
    succeeded("export", script, "-o", target, "--fps", "10", "--quiet")
    beside = {item.suffix for item in folder.iterdir()}
    assert target.stat().st_size > 1000
    if end == ".pc2":
        assert beside == {".pc2", ".obj", ".mtl", ".png"}
        content = target.with_suffix(".obj").read_bytes().splitlines()
        assert content[0] == b"mtllib " + os.fsencode(target.with_suffix(".mtl").name)
        picture = os.fsencode(target.with_name(f"{target.stem}_skin.png").name)
        assert b"map_Kd " + picture in target.with_suffix(".mtl").read_bytes().splitlines()
    else:
        assert beside == {end}
    if end == ".usdz":
        assert zipfile.ZipFile(target).testzip() is None
    if end == ".glb":
        assert b"\\udc" not in target.read_bytes()


@needs_bytes
def test_pictures_with_such_a_name_have_their_passes(tmp_path):
    """Pictures with such names have their passes, also EXR files.

    The EXR library itself accepts no such name.
    """
    OpenEXR = pytest.importorskip("OpenEXR")  # noqa: N806 - a module
    script = pose(tmp_path / "pose.toml")
    picture = tmp_path / RAW_NAME / f"{RAW_NAME}.png"
    succeeded(
        "capture", script, "-o", picture, "--passes", "depth,segmentation,landmarks", *SMALL_OPTIONS
    )
    ends = (".exr", ".json", ".png", "_ldmks.txt", "_seg.png")
    assert sorted(item.name for item in picture.parent.iterdir()) == [
        f"{RAW_NAME}{e}" for e in ends
    ]
    shutil.copy(picture.with_suffix(".exr"), tmp_path / "plain.exr")
    with OpenEXR.File(str(tmp_path / "plain.exr")) as file:
        assert file.channels()["depth.Z"].pixels.max() > 100.0


@pytest.mark.slow
@needs_bytes
def test_sets_and_lists_with_such_names(tmp_path):
    """Texts of sets and lists with such names are UTF-8: card, labels, table of results."""
    backgrounds = tmp_path / f"{RAW_NAME}_pictures"
    backgrounds.mkdir()
    PIL.Image.new("RGB", (80, 64), (20, 90, 60)).save(backgrounds / f"{RAW_NAME}.png")
    folder = tmp_path / f"{RAW_NAME}_set"
    words = ("--background", backgrounds, *SMALL_OPTIONS, "--refiner", "none", "--quiet")
    for count, more in ((1, ()), (2, ("--resume",))):
        succeeded("dataset", "--count", count, "-o", folder, *words, *more)
    assert (
        json.loads((folder / "000000.json").read_text("utf-8"))["background"] == f"{SHOWN_NAME}.png"
    )
    assert f"{SHOWN_NAME}_pictures" in (folder / "README.md").read_text("utf-8")
    listing = tmp_path / f"{RAW_NAME}.txt"
    script = pose(tmp_path / "pose.toml")
    target = tmp_path / "out.npz"
    listing.write_text(f"export '{script}' -o '{target}' --fps 5\n", "utf-8")
    succeeded("batch", listing, "--jobs", 1, "--quiet")
    with (tmp_path / f"{RAW_NAME}_logs" / "summary.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert f"{SHOWN_NAME}_logs" in row["log"]


@needs_bytes
@pytest.mark.parametrize(
    "words",
    [
        ("capture", "NAME.toml", "-o", "face.png"),
        ("capture", "--set", "joy", "-o", "NAME.bmp"),
        ("capture", "--set", "NAME=1", "-o", "face.png"),
        ("capture", "--set", "joy", "-o", "face.png", "--refiner", "NAME"),
        ("capture", "--head", "NAME.obj", "--landmarks", "NAME.json", "-o", "face.png"),
        ("convert", "NAME.csv", "-o", "face.toml"),
        ("export", "NAME.toml", "-o", "NAME.glb"),
        ("dataset", "--count", "1", "-o", "set", "--sample", "NAME.toml"),
        ("batch", "NAME.txt"),
        ("reproduce", "NAME"),
        ("NAME",),
    ],
)
def test_such_a_name_is_reported_in_one_line(words, tmp_path, monkeypatch):
    """Missing files with such names, and meaningless words, are reported in one line."""
    monkeypatch.chdir(tmp_path)
    line = refusal(risorius(*(word.replace("NAME", RAW_NAME) for word in words)))
    assert "cheln" in line
    assert line.isprintable()


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A user's file, and a folder `shared`, in which others made links to it."""
    kept = tmp_path / "mine" / "secret"
    kept.parent.mkdir()
    kept.write_text("mine")
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o1777)  # as /tmp
    names = ("face.png", "face.json", "face.toml", "face.csv", "face.npz", "face.obj", "face.pc2")
    for name in (*names, "face.mtl", "face_skin.png", "face.mp4"):
        (shared / name).symlink_to(kept)
    (shared / "nowhere.png").symlink_to(tmp_path / "mine" / "none.png")
    (shared / "loop.png").symlink_to("loop.png")
    return kept


def check_untouched(secret):
    """Check that the file is unchanged, and alone in its folder."""
    assert secret.read_text() == "mine"
    assert [*secret.parent.iterdir()] == [secret]


def test_an_output_takes_the_place_of_a_link(secret, tmp_path):
    """An output replaces a link; the target of the link stays unchanged, or missing."""
    shared = tmp_path / "shared"
    grey = np.full((8, 8, 3), 128, np.uint8)
    for name in ("face.png", "nowhere.png"):
        check_file(shared / name)
        save_png(shared / name, grey)
        assert not (shared / name).is_symlink()
        assert PIL.Image.open(shared / name).size == (8, 8)
    save_text(shared / "face.toml", "text")
    assert not (shared / "face.toml").is_symlink()
    assert (shared / "face.toml").read_text() == "text"
    with pytest.raises(UserError, match=r"loop.png: is a link that leads back to itself"):
        save_png(shared / "loop.png", grey)
    check_untouched(secret)
    assert not [item for item in shared.iterdir() if item.name.startswith(".risorius")]


@pytest.mark.slow
def test_commands_follow_no_link_that_lies_in_the_place_of_an_output(secret, tmp_path):
    """Commands follow no link that stands in place of an output in a shared folder.

    Outputs are pictures with labels, scripts, motion and films.
    """
    shared = tmp_path / "shared"
    script = pose(tmp_path / "pose.toml")
    recording = take(tmp_path / "take.csv")
    for words in (
        ("capture", script, "-o", shared / "face.png", "--passes", "landmarks", *SMALL_OPTIONS),
        ("capture", script, "-o", shared / "face.mp4", "--fps", "5", *SMALL_OPTIONS),
        ("convert", recording, "-o", shared / "face.toml", "--overwrite"),
        ("export", script, "-o", shared / "face.npz"),
        ("export", script, "-o", shared / "face.csv"),
        ("export", script, "-o", shared / "face.pc2"),
    ):
        succeeded(*words)
    left = [item.name for item in shared.iterdir() if item.is_symlink()]
    assert sorted(left) == ["loop.png", "nowhere.png"]
    check_untouched(secret)


@pytest.mark.slow
def test_frames_and_samples_follow_no_link(secret, tmp_path):
    """Frames in existing folders, and unfinished samples of a set, follow no links."""
    shared = tmp_path / "shared"
    script = pose(tmp_path / "pose.toml")
    frames = shared / "frames"
    frames.mkdir()
    (frames / "frame_00001.png").symlink_to(secret)
    words = ("capture", script, "-o", frames, "--fps", "5", "--overwrite", *SMALL_OPTIONS)
    succeeded(*words)
    made = shared / "set"
    words = ("dataset", "--count", "1", "-o", made, *SMALL_OPTIONS, "--refiner", "none", "--quiet")
    succeeded(*words)
    for name in ("000000.png", "000000.json", "index.csv", "README.md"):
        (made / name).unlink()
        (made / name).symlink_to(secret)
    succeeded(*words, "--resume")
    assert not any(path.is_symlink() for path in (*frames.iterdir(), *made.iterdir()))
    (made / ".unfinished").symlink_to(secret.parent)
    assert ".unfinished: is a link; remove it" in refusal(risorius(*words, "--resume"))
    check_untouched(secret)


def test_an_output_never_replaces_an_input(tmp_path):
    """An output that would replace an input is refused, also if links have other names for it."""
    real, link, other = (tmp_path / name for name in ("real.toml", "link.toml", "other.toml"))
    real.write_text("mine")
    link.symlink_to(real)
    (tmp_path / "here").symlink_to(tmp_path)
    for output, read in ((real, link), (link, link), (tmp_path / "here" / "real.toml", real)):
        with pytest.raises(UserError, match="is both an input and an output"):
            check_apart((output,), (read,))
    with pytest.raises(UserError, match="is the name of two outputs"):
        check_apart((other, tmp_path / "here" / "other.toml"), ())
    check_apart((link, other), (real,))  # the link is replaced, and its target stays
