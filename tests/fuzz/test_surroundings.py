"""Settings, the environment, and what the system refuses: space, memory, files, streams."""

from __future__ import annotations

import math
import os
import resource
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import pytest

from risorius.app.viewer.settings import Settings, load_settings, save_settings, settings_path

from .sandbox import LONGEST, bounded, check_end, check_line, contents
from .sandbox import Ended as End
from .settings_inputs import ENVIRONMENTS, FILES, FILM, IMAGE

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
COMMAND = "import sys; sys.argv[0] = 'risorius'; from risorius.__main__ import run; run()"
STARTING = 60.0  # [s] a process of its own may have to compile first


def numbers_in(stored: Any) -> Iterator[float]:
    """Every number in a table, however deep."""
    if isinstance(stored, dict):
        stored = list(stored.values())
    if isinstance(stored, list | tuple):
        for each in stored:
            yield from numbers_in(each)
    elif isinstance(stored, int | float) and not isinstance(stored, bool):
        yield stored


@pytest.mark.parametrize("name", FILES)
def test_settings(name: str, tmp_path: Path) -> None:
    """A broken file is told in one line; what is taken from it is of the right kind."""
    path = tmp_path / "viewer.json"
    path.write_bytes(FILES[name])
    with bounded(LONGEST):
        settings, told = load_settings(path)
    if told:
        check_line(told)
    for field in fields(Settings):
        value, known = getattr(settings, field.name), getattr(Settings(), field.name)
        assert known is None or isinstance(value, type(known)), field.name
    assert all(math.isfinite(number) for number in numbers_in(asdict(settings)))
    save_settings(path, settings)
    assert load_settings(path) == (settings, "")


@pytest.mark.parametrize("folder", ["", "/", "~", "a\nb", "loop", "notes.txt", "x" * 5000])
def test_places_of_settings(folder: str, sandbox: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever they are said to be: the window opens as it was first."""
    monkeypatch.setenv("XDG_CONFIG_HOME", folder)
    monkeypatch.setenv("HOME", str(sandbox))
    settings, told = load_settings(settings_path())
    assert settings == Settings()
    if told:
        check_line(told)


def start(
    words: str, folder: Path, environment: dict[str, str], limit: Callable[[], None] | None = None
) -> End:
    """Run the command in a process of its own."""
    process = subprocess.run(
        [sys.executable, "-c", COMMAND, *shlex.split(words)],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        errors="surrogateescape",
        timeout=STARTING,
        check=False,
        stdin=subprocess.DEVNULL,
        preexec_fn=limit,
    )
    return End(process.returncode, process.stdout, process.stderr)


def surroundings(**changed: str | None) -> dict[str, str]:
    """The environment of this process, changed, without a screen unless one is named."""
    now = {**os.environ, "DISPLAY": None, **changed}
    return {name: value for name, value in now.items() if value is not None}


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_environments(name: str, sandbox: Path) -> None:
    """It works on, or says in one line what is wrong."""
    changed, words, code = ENVIRONMENTS[name]
    before = contents(sandbox)
    ended = start(words, sandbox, surroundings(**changed))
    assert ended.code == code, ended
    check_end(ended, sandbox, before)


def _limit(kind: int, most: int) -> Callable[[], None]:
    def set_limit() -> None:
        resource.setrlimit(kind, (most, most))

    return set_limit


@pytest.mark.parametrize(
    ("words", "kind", "most", "code"),
    [
        (IMAGE, resource.RLIMIT_FSIZE, 10, 2),
        (FILM, resource.RLIMIT_FSIZE, 100, 2),
        (IMAGE.replace("x.png", "frames"), resource.RLIMIT_FSIZE, 10, 2),
        ("reproduce figure9 -o x.png", resource.RLIMIT_FSIZE, 1000, 2),
        (IMAGE, resource.RLIMIT_NOFILE, 8, 0),
        (IMAGE.replace("16x16", "8000x8000"), resource.RLIMIT_AS, 2 << 30, 2),
    ],
    ids=["png", "mp4", "frames", "figure", "files", "memory"],
)
def test_no_room(words: str, kind: int, most: int, code: int, sandbox: Path) -> None:
    """A full disk, few open files, too little memory: one line, and nothing half written."""
    before = contents(sandbox)
    ended = start(words, sandbox, surroundings(), _limit(kind, most))
    assert ended.code == code, ended
    check_end(ended, sandbox, before)


STREAMS = {
    "out to a full disk": "{risorius} controls > /dev/full",
    "out closed": "{risorius} controls >&-",
    "err closed": "{risorius} nothing 2>&-",
    "err to a full disk": "{risorius} nothing 2> /dev/full",
    "all closed": "{risorius} controls <&- >&- 2>&-",
    "nobody reads on": "{risorius} controls | head -n 1",
    "nobody reads the mistake": "{risorius} nothing 2>&1 | true",
    "folder is gone": "mkdir gone && cd gone && rmdir ../gone && {risorius} nothing",
    "folder is gone, picture": "mkdir gone && cd gone && rmdir ../gone && {risorius} " + IMAGE,
}


@pytest.mark.parametrize("name", STREAMS)
def test_streams_of_the_shell(name: str, sandbox: Path) -> None:
    """Closed and full streams, and a folder that is gone: no traceback, nothing left."""
    before = contents(sandbox)
    command = STREAMS[name].format(risorius=f"{shlex.quote(sys.executable)} -m risorius")
    process = subprocess.run(
        ["sh", "-c", command],
        cwd=sandbox,
        env=surroundings(PYTHONPATH=str(ROOT)),
        capture_output=True,
        text=True,
        timeout=STARTING,
        check=False,
    )
    assert "Traceback" not in process.stderr and "Exception ignored" not in process.stderr
    assert len(process.stderr.splitlines()) <= 1, process.stderr
    assert process.returncode in (0, 1, 2), process
    assert contents(sandbox) == before
