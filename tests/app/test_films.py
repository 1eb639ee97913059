"""Films of every kind: their frames, complete and in order, at any size."""

import subprocess
from dataclasses import replace

import imageio_ffmpeg
import numpy as np
import numpy.typing as npt
import PIL.Image
import pytest

from risorius import render
from risorius.app.capture import Capture, CaptureOptions, capture, outputs, processes
from risorius.app.capture.outputs import FILM_FORMATS
from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene
from risorius.app.script.script_file import parse_script

from .command_line import succeeded

Image = npt.NDArray[np.uint8]
WIDTH = 97
HEIGHT = 63
FRAME_COUNT = 12
RATE = 25.0
SMALL_OPTIONS = CaptureOptions(size=(64, 48), samples=0)


def numbered_frames():
    """Pictures of a bar that moves one step to the right in each picture."""
    frames = []
    for number in range(FRAME_COUNT):
        frame = np.full((HEIGHT, WIDTH, 3), 60, np.uint8)
        frame[:, 7 * number : 7 * number + 14] = 200, 150, 120
        frames.append(frame)
    return frames


def decoded(path, size):
    """All pictures of a film, (n, H, W, 3), read by another program if possible."""
    if path.suffix in (".gif", ".webp"):
        with PIL.Image.open(path) as film:
            assert film.size == size
            assert film.info["loop"] == 0
            pictures = []
            for number in range(getattr(film, "n_frames", 1)):
                film.seek(number)
                pictures.append(np.asarray(film.convert("RGB")))
        return np.array(pictures)
    arguments = ["-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    program = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error"]
    raw = subprocess.run([*program, *arguments], stdout=subprocess.PIPE, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, size[1], size[0], 3)


def seconds_of(path):
    """The duration of a film [s]."""
    if path.suffix not in (".gif", ".webp"):
        return float(imageio_ffmpeg.count_frames_and_secs(str(path))[1])
    total = 0.0
    with PIL.Image.open(path) as film:
        for number in range(getattr(film, "n_frames", 1)):
            film.seek(number)
            film.load()  # before this, Pillow does not know durations in a WebP file
            total += film.info["duration"] / 1000.0
    return total


@pytest.mark.parametrize("suffix", FILM_FORMATS)
def test_frames_are_in_order_and_complete(tmp_path, suffix):
    """Each kind of film, of an odd size, returns every picture at its time."""
    path = tmp_path / f"film{suffix}"
    frames = numbered_frames()
    with outputs.film(path, (WIDTH, HEIGHT), RATE) as add:
        for frame in frames:
            add(frame)
    is_even = suffix == ".mp4"  # H.264 needs even sizes, so the last row and column are cut
    size = (WIDTH - is_even, HEIGHT - is_even)
    found = decoded(path, size)
    assert len(found) == FRAME_COUNT
    for picture, frame in zip(found, frames, strict=True):
        off = np.abs(picture.astype(int) - frame[: size[1], : size[0]])
        assert off.mean() < 6.0  # the next frame differs by 20
    assert seconds_of(path) == pytest.approx(FRAME_COUNT / RATE, abs=0.02)
    assert list(tmp_path.iterdir()) == [path]


def test_a_gif_refuses_frames_that_players_slow_down(tmp_path):
    """Frames of a GIF last at least two hundredths of a second; less is refused in one line.

    Players slow down shorter frames.
    """
    with (
        pytest.raises(UserError, match=r"film.gif: can have at most 50 frames a second, but"),
        outputs.film(tmp_path / "film.gif", (96, 64), 60.0),
    ):
        pass


@pytest.mark.slow
@pytest.mark.parametrize("samples", [0, 4])
@pytest.mark.parametrize("colour", [(255, 255, 255), (0, 0, 0), (0, 177, 64)])
def test_a_transparent_picture_lies_over_any_colour(samples, colour):
    """A transparent picture over white, black or green equals the opaque picture there.

    Its edges have no fringe.
    """
    flat = tuple(part / 255.0 for part in colour)
    background = render.Background(flat, flat)
    pictures = []
    for behind in (background, None):
        style = render.Style(background=behind)
        options = replace(SMALL_OPTIONS, size=(160, 120), samples=samples, style=style)
        with Capture(FaceScene(), options) as studio:
            pictures.append(studio.draw_image())
            has_samples = studio.surface.samples > 1
    opaque, clear = pictures
    alpha = clear[..., 3:] / 255.0
    over = clear[..., :3] * alpha + np.array(colour) * (1.0 - alpha)
    off = np.abs(over - opaque).max(axis=2)
    # Each layer of hair, and each hair of its frayed outline, rounds by up to a level.
    assert (off > 6.0).sum() <= 50
    assert off.max() <= 16.0
    assert off.mean() < 0.2
    assert (clear[0, 0] == 0).all()
    assert 0.2 < alpha.mean() < 0.8
    assert not has_samples or ((alpha > 0.0) & (alpha < 1.0)).sum() > 50


@pytest.mark.parametrize(
    ("word", "corner"),
    [
        ("white", (255, 255, 255)),
        ("black", (0, 0, 0)),
        ("grey", (128, 128, 128)),
        ("#00B140", (0, 177, 64)),
    ],
)
def test_backgrounds_by_name(tmp_path, word, corner):
    """The corner of a picture has exactly the requested colour."""
    path = tmp_path / "picture.png"
    arguments = ["capture", "--scene", "plane", "--size", "64x48", "--time", "0", "-o", str(path)]
    succeeded(*arguments, "--background", word)
    with PIL.Image.open(path) as picture:
        assert picture.mode == "RGB"
        assert picture.getpixel((0, 0)) == corner


# Several drawing processes.


def several(count, monkeypatch):
    """Let this number of processes draw, even for little work."""
    monkeypatch.setattr(processes, "process_count", lambda *_: count)


@pytest.mark.slow
def test_a_range_is_a_part_of_the_film_for_any_number_of_processes(tmp_path, monkeypatch):
    """Frames of a range equal those of the whole film, from one process and from several."""
    text = "duration = 0.5\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 0.5\njoy = 1.0\n"
    script = parse_script(text, source="smile.toml")
    whole = CaptureOptions((96, 72), 10.0)
    part = replace(whole, span=(0.2, 0.5))
    capture(script, whole, output=tmp_path / "whole", progress=False)
    capture(script, part, output=tmp_path / "alone", progress=False)
    monkeypatch.setattr(processes, "process_count", lambda *_: 2)
    capture(script, part, output=tmp_path / "two", progress=False)
    films = [sorted((tmp_path / name).iterdir()) for name in ("whole", "alone", "two")]
    read = [[np.asarray(PIL.Image.open(file)) for file in film] for film in films]
    assert np.array_equal(read[0][2:], read[1])
    assert np.array_equal(read[1], read[2])
