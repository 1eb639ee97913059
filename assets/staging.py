"""A folder beside a file, in which the file is made before it takes its place.

It goes when the work ends. Where the process was killed it stays: the next one that works in the
same place sweeps it away, if it is ours and nobody works in it. A folder is ours by its name and by
who owns it. Whoever works in it holds a lock on it, which ends with the process; the name says on
which machine, since other machines may share the disk but not the locks. Without that knowledge a
folder is left when nothing in it has changed for a day: a run that works changes something every
few minutes.
"""

import contextlib
import hashlib
import os
import platform
import re
import secrets
import shutil
import stat
import sys
import time
from functools import cache
from pathlib import Path
from typing import IO, Any

if sys.platform != "win32":
    import fcntl

PREFIX = ".risorius-"  # what the names of such folders begin with
OLD = 86_400.0  # [s] since the last change in a folder that is swept away
_NAME = re.compile(re.escape(PREFIX) + "([0-9a-f]{12}){1,2}")
_swept: set[Path] = set()  # where this process has looked for what others left


class StagingFolder:
    """A folder in `parent` to make files in; a context manager that gives and removes it.

    Raises OSError where it cannot be made.
    """

    def __init__(self, parent: Path) -> None:
        self._parent = parent
        self._folder: Path | None = None
        self._lock = -1

    def __enter__(self) -> Path:
        if self._parent not in _swept:  # to look through 100 000 files takes a second
            _swept.add(self._parent)
            sweep(self._parent)
        while True:
            self._folder = self._parent / f"{PREFIX}{_machine()}{secrets.token_hex(6)}"
            self._folder.mkdir(mode=0o700)
            # Another process may take it for one that was left, before it is locked.
            with contextlib.suppress(FileNotFoundError, BlockingIOError):
                self._lock = _locked_folder(self._folder)
                if self._folder.exists():
                    return self._folder
            self._unlock()

    def __exit__(self, *_: object) -> None:
        self.remove()

    def remove(self) -> None:
        """Take it away with all that is in it; nothing the second time."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
        self._unlock()

    def _unlock(self) -> None:
        if self._lock >= 0:
            os.close(self._lock)
        self._lock = -1


@cache
def _machine() -> str:
    """Twelve hexadecimal digits of this machine since it was started."""
    name = platform.node()
    with contextlib.suppress(OSError):
        name += Path("/proc/sys/kernel/random/boot_id").read_text()
    return hashlib.sha256(name.encode()).hexdigest()[:12]


def _locked_folder(folder: Path) -> int:
    """A handle that keeps a folder locked until it is closed; -1 where there are no locks.

    Raises BlockingIOError where another handle keeps it locked.
    """
    if sys.platform == "win32":
        return -1
    handle = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(handle)
        if isinstance(error, BlockingIOError):
            raise
        return -1
    return handle


def is_staging_folder(path: Path) -> bool:
    """Whether a path is such a folder, no link to one, and made by this user."""
    try:
        found = path.lstat()
    except OSError:
        return False
    is_own = sys.platform == "win32" or found.st_uid == os.getuid()
    return bool(_NAME.fullmatch(path.name)) and stat.S_ISDIR(found.st_mode) and is_own


def sweep(parent: Path) -> None:
    """Remove the folders in `parent` that killed processes left; see above for which."""
    with contextlib.suppress(OSError):
        for path in [item for item in parent.iterdir() if item.name.startswith(PREFIX)]:
            with contextlib.suppress(OSError):
                if is_staging_folder(path):
                    _remove_if_left(path)


def _remove_if_left(path: Path) -> None:
    """Remove one folder if nobody works in it; OSError where that cannot be known."""
    lock = _locked_folder(path)
    try:
        is_from_here = lock >= 0 and path.name.startswith(PREFIX + _machine())
        if is_from_here or _last_change(path) < time.time() - OLD:
            shutil.rmtree(path, ignore_errors=True)
    finally:
        if lock >= 0:
            os.close(lock)


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
