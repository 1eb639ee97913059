"""Folders in which files are made: gone after the work, and swept away where that was killed."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from risorius.assets import staging
from risorius.assets.staging import StagingFolder, is_staging_folder, sweep

KILLED = (
    "import os, pathlib, signal, sys\nfrom risorius.assets.staging import StagingFolder\n"
    "made = StagingFolder(pathlib.Path(sys.argv[1])).__enter__()\n"
    "(made / 'film.mp4').write_bytes(b'half')\nos.kill(os.getpid(), signal.SIGKILL)"
)


def made_old(folder: Path, seconds: float = staging.OLD + 60.0) -> Path:
    """Let the last change in a folder be so long ago."""
    when = time.time() - seconds
    for path in (*folder.rglob("*"), folder):
        os.utime(path, (when, when), follow_symlinks=False)
    return folder


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    """What a process on another machine left that was killed while it made a film."""
    path = tmp_path / f"{staging.PREFIX}{'0' * 24}"
    path.mkdir(mode=0o700)
    (path / "film.mp4").write_bytes(b"half")
    return path


def test_a_folder_is_gone_after_the_work(tmp_path: Path) -> None:
    """However the work ends."""
    with StagingFolder(tmp_path) as folder:
        (folder / "x").touch()
        assert is_staging_folder(folder) and list(tmp_path.iterdir()) == [folder]
    with pytest.raises(RuntimeError, match="in the middle"), StagingFolder(tmp_path):
        raise RuntimeError("in the middle")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
def test_what_a_killed_process_leaves_is_swept_away(tmp_path: Path) -> None:
    """At once, by the next one that works there; not what another process is working in."""
    with StagingFolder(tmp_path) as busy:
        made_old(busy)
        ended = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
        assert ended.returncode == -signal.SIGKILL
        assert len(list(tmp_path.iterdir())) == 2
        staging._swept.clear()  # as in another process
        with StagingFolder(tmp_path) as own:
            assert set(tmp_path.iterdir()) == {busy, own}


def test_a_film_that_still_grows_stays(killed: Path) -> None:
    """Where another machine that shares the disk writes it, for locks may not be shared."""
    made_old(killed)
    (killed / "film.mp4").write_bytes(b"more")
    sweep(killed.parent)
    assert killed.exists()
    made_old(killed)
    sweep(killed.parent)
    assert not killed.exists()


@pytest.mark.parametrize(
    "change",
    [
        lambda path: path.rename(path.with_name(".risorius-old")),
        lambda path: path.rename(path.with_name(path.name + "0")),
        lambda path: path.rename(path.with_name(path.name.lstrip("."))),
        lambda path: (path.rename(path.parent / "real"), path.symlink_to(path.parent / "real")),
        lambda path: (shutil.rmtree(path), path.write_text("a file")),
    ],
)
def test_nothing_else_is_swept_away(killed: Path, change: object) -> None:
    """Another name, a link, a file: all stay."""
    folder = killed.parent
    assert is_staging_folder(killed)
    change(killed)  # type: ignore[operator]
    made_old(folder)
    before = sorted(folder.rglob("*"))
    sweep(folder)
    assert sorted(folder.rglob("*")) == before


@pytest.mark.skipif(sys.platform == "win32", reason="owners of POSIX systems")
def test_what_others_own_stays(killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another user's folder is that user's to sweep."""
    made_old(killed)
    own = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: own + 1)
    sweep(killed.parent)
    assert killed.exists()
