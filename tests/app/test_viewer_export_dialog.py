"""File > Export with mouse and keys: films, motion, progress, cancel, errors."""

import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from risorius.app import workers
from risorius.app.capture import CaptureOptions
from risorius.app.capture import capture as film_of
from risorius.app.capture.drawing import camera_for
from risorius.app.light_maps import open_light, read_light_map
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.refining.presets import Refinement
from risorius.app.script.script_file import parse_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.settings import ExportChoices
from risorius.render import Style

from ..heads import user_head
from .driving import (
    NAP,
    NEEDS_A_SCREEN,
    clear_search,
    click,
    press_keys,
    put,
    settle,
    show_controls,
    until,
    write,
)
from .glb_player import document
from .light_files import write_map

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]

SCRIPT = "duration = 0.5\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 0.5\nname = 'j'\njoy = 1.0\n"
SMALL_SIZE = (160, 120)
EXPORT_LIMIT = 120.0  # [s] limit for an export, which starts a process


@pytest.fixture(autouse=True)
def _at_first(viewer: Viewer, tmp_path: Path, calm: None) -> Iterator[None]:
    """Start with a script of half a second, few small pictures, in the test's folder."""
    open_script(viewer, SCRIPT)
    viewer.settings.export = ExportChoices("frames", size=SMALL_SIZE, rate=12.0)
    yield
    viewer.exporter.close()
    viewer.exporter.is_asking = False
    settle(viewer)


def open_script(viewer, text):
    """Replace the script by one with this text."""
    viewer.session.work.open(parse_script(text, source="smile.toml"))


def finish(viewer, *key):
    """Open the dialog, accept its current choices, and wait until the file is written."""
    press_keys(viewer, *(key or ("F10",)))
    assert until(viewer, lambda: "export: begin" in viewer.gui.places)
    begin(viewer)
    assert until(viewer, lambda: viewer.exporter.job is not None), viewer.messages.text
    assert until(viewer, lambda: viewer.exporter.job is None, EXPORT_LIMIT, nap=NAP)


def begin(viewer, name=""):
    """Continue to the file chooser, and accept its suggested name or give another."""
    click(viewer, "export: begin")
    assert viewer.files.is_waiting
    if name:
        press_keys(viewer, "ctrl+a")
        write(viewer, name)
    press_keys(viewer, "Return")


def pictures(folder):
    """All pictures in a folder, in order, (N, H, W, 3 or 4)."""
    files = sorted(folder.glob("*.png"))
    return np.stack([np.asarray(Image.open(file)) for file in files]).astype(int)


def test_a_film_is_that_of_capture(viewer, tmp_path):
    """The film has the frames of `capture` with the same options, here in the light of a map.

    The face is unchanged.
    """
    scene = viewer.session.scene
    viewer.face.view.camera = camera_for(scene, "three-quarter")
    viewer.settings.display.light = open_light(write_map(tmp_path / "sky.hdr"))
    viewer.settings.display.background = "map"
    viewer.settings.display.look = "paper"
    before = scene.positions.copy()
    finish(viewer)
    assert not viewer.messages.is_error
    assert np.array_equal(scene.positions, before)
    assert str(tmp_path / "smile") in viewer.messages.text
    assert viewer.messages.stays
    sky = read_light_map(tmp_path / "sky.hdr")
    style = Style(light=sky.light(), background=sky.background())
    options = CaptureOptions(
        SMALL_SIZE, 12.0, Refinement("paper"), camera="three-quarter", style=style
    )
    film_of(viewer.session.script, options, output=tmp_path / "captured", progress=False)
    ours = pictures(tmp_path / "smile")
    captured = pictures(tmp_path / "captured")
    assert ours.shape == captured.shape == (7, 120, 160, 3)
    assert np.abs(ours - captured).max() <= 2
    press_keys(viewer, "n")
    assert not viewer.messages.text  # the next command removes it


@pytest.mark.slow
def test_pictures_are_written_into_a_folder_again(viewer, tmp_path):
    """For a folder that exists, the dialog asks; only pictures of an earlier film are replaced."""
    folder = tmp_path / "smile"
    folder.mkdir()
    (folder / "notes.txt").write_text("precious")
    (folder / "frame_00099.png").write_bytes(b"of an earlier film")
    press_keys(viewer, "F10")
    begin(viewer)
    assert viewer.files.request.complaint == "smile is there already; other files in it stay"
    assert viewer.exporter.job is None
    press_keys(viewer, "Return")
    assert until(viewer, lambda: viewer.exporter.job is not None), viewer.messages.text
    assert until(viewer, lambda: viewer.exporter.job is None, EXPORT_LIMIT, nap=NAP)
    assert not viewer.messages.is_error
    assert (folder / "notes.txt").read_text() == "precious"
    assert pictures(folder).shape == (7, 120, 160, 3)


@pytest.mark.slow
def test_motion_is_exported_by_the_same_dialog(viewer, tmp_path):
    """The same dialog writes the file of `risorius export`, under the typed name."""
    press_keys(viewer, "ctrl+e")
    click(viewer, "Write")
    click(viewer, "Write: Motion: numpy arrays (.npz)")
    begin(viewer, "moved")
    assert until(viewer, lambda: viewer.exporter.job is not None), viewer.messages.text
    assert until(viewer, lambda: viewer.exporter.job is None, EXPORT_LIMIT, nap=NAP)
    assert "moved.npz" in viewer.messages.text
    assert not viewer.messages.is_error
    with np.load(tmp_path / "moved.npz") as arrays:
        assert len(arrays["positions"]) == 7


@pytest.mark.slow
def test_the_window_responds_and_cancel_leaves_nothing(viewer, tmp_path, monkeypatch):
    """The face responds during an export; cancel leaves neither a file nor a part of one."""
    monkeypatch.setattr(workers, "GRACE_TIME", EXPORT_LIMIT)
    viewer.settings.export.kind = "mp4"
    open_script(viewer, SCRIPT.replace("0.5", "600.0"))
    press_keys(viewer, "F10")
    begin(viewer)
    job = viewer.exporter.job
    assert until(viewer, lambda: job.task.share > 0.0, EXPORT_LIMIT, nap=NAP)
    press_keys(viewer, "1")
    assert viewer.session.is_solo("joy")
    press_keys(viewer, "ctrl+q")
    assert "mp4 is being written" in viewer.messages.text
    assert not viewer.surface.should_close
    process = job.task._pool._workers[0].process
    process.send_signal(signal.SIGSTOP)  # it needs time to end
    click(viewer, "export: stop")
    press_keys(viewer, "2")
    assert viewer.session.is_solo("sadness")
    assert viewer.exporter.job is job
    process.send_signal(signal.SIGCONT)
    assert until(viewer, lambda: viewer.exporter.job is None)
    assert "Cancelled" in viewer.messages.text
    assert not viewer.messages.is_error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["mp4", "npz"])
def test_a_bad_folder_is_one_line(viewer, kind):
    """A wrong folder is reported at once; the typed name and all choices stay for another try."""
    viewer.settings.export.kind = kind
    press_keys(viewer, "F10")
    begin(viewer, "/proc/none/moved")
    assert until(viewer, lambda: "cannot be written" in viewer.messages.text)
    assert viewer.messages.is_error
    assert "\n" not in viewer.messages.text
    assert viewer.exporter.job is None
    assert viewer.settings.export.kind == kind
    assert viewer.files.request.name == "/proc/none/moved"
    press_keys(viewer, "Escape")
    assert not viewer.files.is_waiting


@pytest.mark.parametrize(
    "words",
    [
        "blendshape",
        *(
            pytest.param(words, marks=pytest.mark.slow)
            for words in ("morph", "shape key", "ARKit", "avatar", "gltf")
        ),
    ],
)
def test_search_finds_the_avatar(viewer, words):
    """Each usual word finds a button for the avatar's file."""
    show_controls(viewer, words)
    click(viewer, "found Avatar ...")
    assert viewer.files.is_waiting
    press_keys(viewer, "Escape")
    clear_search(viewer)
    assert "found Avatar ..." not in viewer.gui.places


def test_search_finds_films_and_motion(viewer):
    """File suffixes find a button that opens the export dialog."""
    for words in ("mp4", "usd"):
        show_controls(viewer, words)
        click(viewer, "found Film, pictures or motion ...")
        assert viewer.exporter.is_asking, words
        press_keys(viewer, "Escape")
        clear_search(viewer)


@pytest.mark.slow
def test_a_head_of_the_user_becomes_an_avatar(viewer, tmp_path):
    """File > Export > Avatar writes the file's vertices with ARKit's 52 shapes.

    The window shows the progress.
    """
    before = viewer.session.scene
    mesh, marks = user_head().write(tmp_path)
    put(viewer, mesh, marks)
    assert until(viewer, lambda: not viewer.file_drop.is_making)
    click(viewer, "menu File")
    click(viewer, "menu File: Export")
    click(viewer, "menu File: Avatar ...")
    assert viewer.files.is_waiting
    press_keys(viewer, "Return")
    assert until(viewer, lambda: viewer.exporter.job is not None), viewer.messages.text
    viewer.show_scene(before)
    job = viewer.exporter.job
    assert job.target.name == f"{mesh.stem}-avatar.glb"
    assert until(viewer, lambda: 0.2 < job.task.share < 1.0, EXPORT_LIMIT, nap=NAP)
    assert until(viewer, lambda: viewer.exporter.job is None, EXPORT_LIMIT, nap=NAP)
    assert not viewer.messages.is_error, viewer.messages.text
    found = document(job.target)
    head = next(each for each in found["meshes"] if each["name"] == "head")
    assert tuple(head["extras"]["targetNames"]) == ARKIT_SHAPES
    position = head["primitives"][0]["attributes"]["POSITION"]
    assert found["accessors"][position]["count"] == len(user_head().mesh.vertices)
    assert "teeth_lower" in {each["name"] for each in found["meshes"]}
