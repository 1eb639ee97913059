"""A folder beside a file, in which the file is made before it takes its place.

It goes when the work ends. Where the process was killed it stays: the next one that works in the
same place sweeps it away, if it is ours and old. A folder is ours by its name and by who owns it,
and old a day after the last change in it: a run that works changes something every few minutes. A
process that takes the place of one that died is told the mark in the names of that one's folders,
and waits no day.
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
MARK = "RISORIUS_MARK"  # environment: what names go on with, 12 hexadecimal digits or nothing
DIED = "RISORIUS_DIED"  # environment: the mark of the one that died
_NAME = re.compile(re.escape(PREFIX) + "([0-9a-f]{12}){1,2}")
_swept: set[Path] = set()  # where this process has looked for what others left


class StagingFolder:
    """A folder in `parent` to make files in; a context manager that gives and removes it.

    Raises OSError where it cannot be made.
    """

    def __init__(self, parent: Path) -> None:
        self._folder = parent / f"{PREFIX}{os.environ.get(MARK, '')}{secrets.token_hex(6)}"

    def __enter__(self) -> Path:
        if self._folder.parent not in _swept:  # to look through 100 000 files takes a second
            _swept.add(self._folder.parent)
            sweep(self._folder.parent)
        self._folder.mkdir(mode=0o700)
        return self._folder

    def __exit__(self, *_: object) -> None:
        self.remove()

    def remove(self) -> None:
        """Take it away with all that is in it; nothing the second time."""
        shutil.rmtree(self._folder, ignore_errors=True)


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
    died = os.environ.get(DIED)
    with contextlib.suppress(OSError):
        for path in [item for item in parent.iterdir() if item.name.startswith(PREFIX)]:
            with contextlib.suppress(OSError):
                if is_staging_folder(path) and (
                    (died and path.name.startswith(PREFIX + died))
                    or _last_change(path) < time.time() - OLD
                ):
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
