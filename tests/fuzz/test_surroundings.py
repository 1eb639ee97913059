"""Settings, environment variables, and limits of the system: disk, memory, files, streams."""

import os
import resource
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from risorius.app.viewer.settings import Settings, load_settings, settings_path

from .sandbox import Ended as End
from .sandbox import check_end, check_line, contents

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
COMMAND_PROGRAM = "import sys; sys.argv[0] = 'risorius'; from risorius.__main__ import run; run()"
STARTING_LIMIT = 120.0  # [s] a separate process may have to compile first
# A changed variable (None: removed), the words of the command, and its exit code.
Row = tuple[dict[str, str | None], str, int]
IMAGE_COMMAND = "capture --scene plane --set amplitude -o x.png --size 16x16 --quiet"
FILM_COMMAND = "capture --scene plane --set amplitude -o x.mp4 --size 16x16 --quiet"
ENVIRONMENTS = {
    "nothing at all": ({"PATH": None, "HOME": None, "LANG": None}, IMAGE_COMMAND, 0),
    "home is nowhere": ({"HOME": "/proc/nowhere", "XDG_CACHE_HOME": None}, IMAGE_COMMAND, 0),
    "wrong language": ({"LC_ALL": "xx_YY.nothing"}, IMAGE_COMMAND, 0),
    "no film program": ({"IMAGEIO_FFMPEG_EXE": "/nowhere/ffmpeg"}, FILM_COMMAND, 2),
    "no OpenGL": ({"GLCONTEXT_LINUX_LIBEGL": "nothing.so"}, IMAGE_COMMAND, 2),
    "no screen": ({"DISPLAY": None, "WAYLAND_DISPLAY": None}, "view", 2),
    "settings in a file": ({"XDG_CONFIG_HOME": "notes.txt", "DISPLAY": None}, "view", 2),
    "compiler is switched off": ({"NUMBA_DISABLE_JIT": "1"}, "doctor --offscreen", 0),
}


@pytest.mark.parametrize("folder", ["", "/", "~", "a\nb", "loop", "notes.txt", "x" * 5000])
def test_places_of_settings(folder, sandbox, monkeypatch):
    """For any place of the settings file, the window opens with its defaults."""
    monkeypatch.setenv("XDG_CONFIG_HOME", folder)
    monkeypatch.setenv("HOME", str(sandbox))
    settings, message = load_settings(settings_path())
    assert settings == Settings()
    if message:
        check_line(message)


def start(words, folder, environment, limit=None):
    """Run the command in a separate process."""
    process = subprocess.run(
        [sys.executable, "-c", COMMAND_PROGRAM, *shlex.split(words)],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        errors="surrogateescape",
        timeout=STARTING_LIMIT,
        check=False,
        stdin=subprocess.DEVNULL,
        preexec_fn=limit,
    )
    return End(process.returncode, process.stdout, process.stderr)


def surroundings(**changed):
    """The environment of this process with changes, and without a screen unless one is given."""
    now = {**os.environ, "DISPLAY": None, **changed}
    return {name: value for name, value in now.items() if value is not None}


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_environments(name, sandbox):
    """In each environment the command succeeds, or names the fault in one line."""
    changed, words, code = ENVIRONMENTS[name]
    before = contents(sandbox)
    ended = start(words, sandbox, surroundings(**changed))
    assert ended.code == code, ended
    check_end(ended, sandbox, before)


def _limit(kind, most):
    def set_limit():
        resource.setrlimit(kind, (most, most))

    return set_limit


@pytest.mark.parametrize(
    ("words", "kind", "most", "code"),
    [
        (IMAGE_COMMAND, resource.RLIMIT_FSIZE, 10, 2),
        (FILM_COMMAND, resource.RLIMIT_FSIZE, 100, 2),
        (IMAGE_COMMAND.replace("x.png", "frames"), resource.RLIMIT_FSIZE, 10, 2),
        ("reproduce figure9 -o .", resource.RLIMIT_FSIZE, 1000, 2),
        (IMAGE_COMMAND, resource.RLIMIT_NOFILE, 8, 0),
        (IMAGE_COMMAND.replace("16x16", "8000x8000"), resource.RLIMIT_AS, 2 << 30, 2),
    ],
    ids=["png", "mp4", "frames", "figure", "files", "memory"],
)
def test_no_room(words, kind, most, code, sandbox):
    """With a full disk, few open files or too little memory, one line is printed.

    No partial file is left.
    """
    before = contents(sandbox)
    ended = start(words, sandbox, surroundings(), _limit(kind, most))
    assert ended.code == code, ended
    check_end(ended, sandbox, before)


STREAMS = {
    "out to a full disk": "{risorius} controls > /dev/full",
    "out closed": "{risorius} controls >&-",
    "all closed": "{risorius} controls <&- >&- 2>&-",
    "nobody reads on": "{risorius} controls | head -n 1",
    "folder is gone, picture": "mkdir gone && cd gone && rmdir ../gone && {risorius} "
    + IMAGE_COMMAND,
}


@pytest.mark.parametrize("name", STREAMS)
def test_streams_of_the_shell(name, sandbox):
    """Closed streams, full streams and a removed folder give no traceback, and no file is left."""
    before = contents(sandbox)
    command = STREAMS[name].format(risorius=f"{shlex.quote(sys.executable)} -m risorius")
    process = subprocess.run(
        ["sh", "-c", command],
        cwd=sandbox,
        env=surroundings(PYTHONPATH=str(ROOT)),
        capture_output=True,
        text=True,
        timeout=STARTING_LIMIT,
        check=False,
    )
    assert "Traceback" not in process.stderr
    assert "Exception ignored" not in process.stderr
    assert len(process.stderr.splitlines()) <= 1, process.stderr
    assert process.returncode in (0, 1, 2), process
    assert contents(sandbox) == before
