"""Working folders: removed after the work, and cleaned up after a kill."""

import os
import shutil
import time
from pathlib import Path

import pytest

from risorius.app import staging
from risorius.app.staging import StagingFolder, is_staging_folder, sweep


def made_old(folder):
    """Set a folder's modification time to more than a day ago."""
    when = time.time() - staging.LEAST_AGE - 60.0
    for path in (*folder.rglob("*"), folder):
        os.utime(path, (when, when), follow_symlinks=False)
    return folder


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    """A folder left by a process that was killed while writing a film."""
    (path := tmp_path / ".risorius-0123456789ab").mkdir(mode=0o700)
    (path / "film.mp4").write_bytes(b"half")
    return path


def test_a_folder_is_removed_after_the_work(tmp_path):
    """The folder is removed however the work ends."""
    with StagingFolder(tmp_path) as folder:
        (folder / "x").touch()
        assert is_staging_folder(folder)
        assert list(tmp_path.iterdir()) == [folder]
    with pytest.raises(RuntimeError, match="in the middle"), StagingFolder(tmp_path):
        raise RuntimeError("in the middle")
    assert list(tmp_path.iterdir()) == []


def test_the_folder_of_a_killed_process_is_removed(killed):
    """The next process removes a killed process's folder, but not one with a growing film."""
    made_old(killed)
    (killed / "film.mp4").write_bytes(b"more")
    sweep(killed.parent)
    assert killed.exists()
    made_old(killed)
    with StagingFolder(killed.parent) as own:
        assert list(killed.parent.iterdir()) == [own]


@pytest.mark.parametrize(
    "change",
    [
        lambda path: path.rename(path.with_name(".risorius-old")),
        lambda path: path.rename(path.with_name(path.name.lstrip("."))),
        lambda path: (path.rename(path.parent / "real"), path.symlink_to(path.parent / "real")),
        lambda path: (shutil.rmtree(path), path.write_text("a file")),
    ],
)
def test_nothing_else_is_removed(killed, change):
    """Folders with other names, links and files stay."""
    folder = killed.parent
    change(killed)
    made_old(folder)
    before = sorted(folder.rglob("*"))
    sweep(folder)
    assert sorted(folder.rglob("*")) == before
