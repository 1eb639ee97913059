"""Outputs: complete or missing."""

import numpy as np
import pytest

from risorius.app.capture import outputs
from risorius.app.errors import UserError

GREY_PICTURE = np.full((64, 96, 3), 128, np.uint8)


def test_a_broken_film_leaves_the_old_one(tmp_path):
    """If the program fails while a film is written, the user's earlier film stays."""
    path = tmp_path / "film.mp4"
    path.write_bytes(b"mine")
    with (
        pytest.raises(RuntimeError, match="in the middle"),
        outputs.film(path, (96, 64), 25) as add,
    ):
        add(GREY_PICTURE)
        raise RuntimeError("in the middle")
    assert path.read_bytes() == b"mine"
    assert list(tmp_path.iterdir()) == [path]


def test_frames_in_a_folder(tmp_path):
    """Frames are numbered pictures in an empty folder.

    With --overwrite other content is accepted, and only earlier frames are removed.
    """
    target = tmp_path / "frames"
    with outputs.folder(target, overwrite=False) as add:
        add(GREY_PICTURE)
        add(GREY_PICTURE)
    assert sorted(item.name for item in target.iterdir()) == ["frame_00000.png", "frame_00001.png"]
    (target / "notes.txt").write_text("mine")
    with (
        pytest.raises(UserError, match="not empty; choose another folder, or add --overwrite"),
        outputs.folder(target, overwrite=False),
    ):
        pass
    with outputs.folder(target, overwrite=True) as add:
        add(GREY_PICTURE)
    assert sorted(item.name for item in target.iterdir()) == ["frame_00000.png", "notes.txt"]
    assert list(tmp_path.iterdir()) == [target]


def test_broken_frames_leave_the_folder_as_it_was(tmp_path):
    """If the program fails while frames are written, old frames stay; a new folder is removed."""
    for name in ("old", "new"):
        if name == "old":
            with outputs.folder(tmp_path / name, overwrite=False) as add:
                add(GREY_PICTURE)
        with (
            pytest.raises(RuntimeError, match="in the middle"),
            outputs.folder(tmp_path / name, overwrite=True) as add,
        ):
            add(GREY_PICTURE)
            add(GREY_PICTURE)
            raise RuntimeError("in the middle")
    left = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*"))
    assert left == ["old", "old/frame_00000.png"]


@pytest.mark.parametrize(
    ("program", "message"),
    [
        (None, r"no film without ffmpeg: .*/ffmpeg: No such file or directory"),
        ("exit 3", r"film.mp4: cannot be written: ffmpeg: it ended with code 3"),
        (
            "cat >/dev/null; echo '[mp4 @ 0x55] No space left on device' >&2; exit 1",
            r"film.mp4: cannot be written: ffmpeg: No space left on device",
        ),
    ],
)
def test_a_film_that_ffmpeg_does_not_finish(tmp_path, monkeypatch, program, message):
    """If ffmpeg is missing, stops, or fails at the end, one line reports it; the old film stays."""
    fake = tmp_path / "ffmpeg"
    film = tmp_path / "films" / "film.mp4"
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(fake))
    if program is not None:
        fake.write_text(f"#!/bin/sh\n{program}\n")
        fake.chmod(0o755)
    film.parent.mkdir()
    film.write_bytes(b"mine")
    with pytest.raises(UserError, match=message), outputs.film(film, (96, 64), 25.0) as add:
        for _ in range(20):
            add(GREY_PICTURE)
    assert film.read_bytes() == b"mine"
    assert list(film.parent.iterdir()) == [film]
