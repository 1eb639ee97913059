"""The command as a process that is stopped by signals and closed terminals."""

import os
import signal
import sys
import time

import pytest

from .command_line import started

SLOW_COMMAND = ("capture", "--scene", "face", "--size", "320x240")


def is_there(folder, pattern):
    """Whether a file with this name is in the folder or below."""
    try:
        return any(folder.glob(pattern))
    except FileNotFoundError:  # a folder was removed during the search
        return False


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
@pytest.mark.parametrize(
    ("output", "pattern", "number"),
    [
        ("film.mp4", "*", signal.SIGINT),  # the output's folder is checked; OpenGL starts next
        ("film.mp4", "**/film.mp4", signal.SIGHUP),
        ("frames", "*", signal.SIGHUP),
        ("frames", "**/*.png", signal.SIGINT),
    ],
)
def test_nothing_half_written_is_left(tmp_path, output, pattern, number):
    """Ctrl-C or a closed terminal, at the start or while files are written, leaves no file.

    Outputs are a film and frames.
    """
    words = ("-m", "risorius", *SLOW_COMMAND, "-o", tmp_path / output, "--quiet")
    process = started(*words, start_new_session=True)
    while process.poll() is None and not is_there(tmp_path, pattern):
        time.sleep(0.01)
    os.killpg(process.pid, number)
    _, message = process.communicate(timeout=60)
    assert process.returncode == -number
    # The first start on a machine also reports compilation.
    lines = [line for line in message.splitlines() if not line.startswith(b"Compiling")]
    assert lines == ([b"risorius: stopped"] if number == signal.SIGINT else [])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
def test_a_film_can_be_stopped_while_it_is_finished(tmp_path):
    """Ctrl-C while ffmpeg finishes, after all frames were sent, leaves no film."""
    slow = tmp_path / "slow_ffmpeg"
    slow.write_text("#!/bin/sh\ncat > /dev/null\ntouch $0.has_all\nexec sleep 100\n")
    slow.chmod(0o755)
    folder = tmp_path / "films"
    code = (
        "import numpy, pathlib\nfrom risorius.app import stopping\n"
        "from risorius.app.capture import outputs\nstopping.handle_signals()\n"
        f"with outputs.film(pathlib.Path({str(folder / 'film.mp4')!r}), (16, 16), 30) as add:\n"
        "    add(numpy.zeros((16, 16, 3), numpy.uint8))"
    )
    process = started("-c", code, env={**os.environ, "IMAGEIO_FFMPEG_EXE": str(slow)})
    while process.poll() is None and not (tmp_path / "slow_ffmpeg.has_all").exists():
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    try:
        _, message = process.communicate(timeout=20)
    finally:
        process.kill()
    assert (process.returncode, message) == (-signal.SIGINT, b"risorius: stopped\n")
    assert list(folder.iterdir()) == []
