"""Temporary folders beside an output, in which files are made before they move to their place.

The folder is removed when the work ends. If the process is killed, the folder stays. A later
process that works in the same place removes it, if no file in it has changed for a day; a running
process changes a file every few minutes.
"""

import contextlib
import os
import re
import secrets
import shutil
import sys
import time
from pathlib import Path
from typing import IO, Any

if sys.platform != "win32":
    import fcntl

LEAST_AGE = 86_400.0  # [s] since the last change in a folder before its removal
_swept: set[Path] = set()  # parent folders that this process has cleaned


class StagingFolder:
    """A context manager for a temporary folder in `parent`.

    Raises OSError if the folder cannot be made.
    """

    def __init__(self, parent: Path) -> None:
        self._parent = parent
        self._folder: Path | None = None

    def __enter__(self) -> Path:
        # Only once, because a search in 100 000 files takes a second.
        if self._parent not in _swept:
            _swept.add(self._parent)
            sweep(self._parent)
        folder = self._parent / f".risorius-{secrets.token_hex(6)}"
        self._folder = folder
        folder.mkdir(mode=0o700)
        return folder

    def __exit__(self, *_: object) -> None:
        self.remove()

    def remove(self) -> None:
        """Remove the folder with its content; a second call does nothing."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)


def is_staging_folder(path: Path) -> bool:
    """Whether a path is a staging folder, and not a link to one."""
    name_pattern = re.compile(r"\.risorius-[0-9a-f]{12}")
    return bool(name_pattern.fullmatch(path.name)) and path.is_dir() and not path.is_symlink()


def sweep(parent: Path) -> None:
    """Remove the folders in `parent` that killed processes left a day ago or longer."""
    with contextlib.suppress(OSError):
        for path in list(filter(is_staging_folder, parent.iterdir())):
            with contextlib.suppress(OSError):  # another process may be faster
                changes = [each.lstat().st_mtime for each in (path, *path.rglob("*"))]
                if max(changes) < time.time() - LEAST_AGE:
                    shutil.rmtree(path, ignore_errors=True)


def locked(path: Path) -> IO[Any] | None:
    """Open and lock a file, which is made if missing; closing it releases the lock.

    Returns None if another process has locked it. Raises OSError if it cannot be opened.
    """
    file = open(path, "ab", opener=_without_waiting)
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        file.close()
        return None
    except OSError:
        pass  # a file system without locks
    return file


def _without_waiting(path: str, flags: int) -> int:
    """Open a file without blocking; raise OSError for a pipe or a link."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0), 0o666)
