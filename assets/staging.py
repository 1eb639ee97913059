"""A folder beside a file, in which the file is made before it takes its place.

It goes when the work ends. Where the process was killed it stays: the next one that works in the
same place sweeps it away, if it is ours, left and old. A folder is ours by its name, by the mark
in it and by who owns it; it is left if nobody has locked the mark, for the system lets go of locks
however a process ends; and it is old a day after the last change in it, because other machines
that share a disk may not see the lock, and a run that works changes something every few minutes.
"""

import contextlib
import os
import re
import secrets
import shutil
import stat
import sys
import time
from pathlib import Path
from typing import IO, Any

PREFIX = ".risorius-"  # what the names of such folders begin with
OLD = 86_400.0  # [s] since the last change in a folder that is swept away
MARK = "made-by-risorius"  # the file in it that says so, and is locked
INSIDE = "new"  # the folder in it that holds what is made
_NAME = re.compile(re.escape(PREFIX) + "[0-9a-f]{12}")
_MARK_TEXT = b"Risorius makes files here, and takes this folder away when they are made.\n"
_swept: set[Path] = set()  # where this process has looked for what others left


class StagingFolder:
    """A folder in `parent` to make files in; a context manager that gives and removes it.

    Raises OSError where it cannot be made.
    """

    def __init__(self, parent: Path) -> None:
        self._folder = parent / f"{PREFIX}{secrets.token_hex(6)}"
        self._lock: IO[Any] | None = None

    def __enter__(self) -> Path:
        if self._folder.parent not in _swept:  # to look through 100 000 files takes a second
            _swept.add(self._folder.parent)
            sweep(self._folder.parent)
        try:
            self._folder.mkdir(mode=0o700)
            self._lock = locked(self._folder / MARK)
            if self._lock is not None:
                self._lock.write(_MARK_TEXT)
                self._lock.flush()
            (self._folder / INSIDE).mkdir()
        except BaseException:
            self.remove()
            raise
        return self._folder / INSIDE

    def __exit__(self, *_: object) -> None:
        self.remove()

    def remove(self) -> None:
        """Take it away with all that is in it; nothing the second time."""
        if self._lock is not None:
            with contextlib.suppress(OSError):  # on a full disk the mark cannot be written out
                self._lock.close()
        shutil.rmtree(self._folder, ignore_errors=True)


def is_staging_folder(path: Path) -> bool:
    """Whether a path is such a folder, made by this user, with nothing else in it."""
    try:
        found = path.lstat()
        is_own = sys.platform == "win32" or found.st_uid == os.getuid()
        if not (_NAME.fullmatch(path.name) and stat.S_ISDIR(found.st_mode) and is_own):
            return False
        names = set(os.listdir(path))
        mark = (path / MARK).lstat()
        if not (names <= {MARK, INSIDE} and stat.S_ISREG(mark.st_mode)):
            return False
        if INSIDE in names and not stat.S_ISDIR((path / INSIDE).lstat().st_mode):
            return False
        return mark.st_size == len(_MARK_TEXT) and (path / MARK).read_bytes() == _MARK_TEXT
    except OSError:
        return False


def sweep(parent: Path) -> None:
    """Remove the folders in `parent` that killed processes left more than a day ago."""
    with contextlib.suppress(OSError):
        for path in [item for item in parent.iterdir() if item.name.startswith(PREFIX)]:
            with contextlib.suppress(OSError):
                if is_staging_folder(path) and _last_change(path) < time.time() - OLD:
                    lock = locked(path / MARK)
                    if lock is not None:
                        lock.close()
                        shutil.rmtree(path, ignore_errors=True)


def _last_change(path: Path) -> float:
    """The latest time at which anything in a folder was changed [s since 1970]."""
    inside = path.rglob("*")
    return max(each.lstat().st_mtime for each in (path, *inside))


def locked(path: Path) -> IO[Any] | None:
    """The file, made if need be, which nobody else can lock until it is closed.

    None where somebody has locked it. Raises OSError where it cannot be opened.
    """
    file = open(path, "ab", opener=_without_waiting)
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        file.close()
        return None
    except OSError:
        pass  # a file system without locks
    return file


def _without_waiting(path: str, flags: int) -> int:
    """Open a file; a pipe in its place, for which one would wait, is an OSError, as is a link."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0), 0o666)
