"""Files for work that no file of the user's has: plain scripts, in a folder beside the settings.

    NAME.script.toml     the script, where it says what its own file does not
    NAME.recording.toml  what is being recorded
    NAME.pose.toml       a pose made by hand
    NAME.lock            locked by the window whose work it is, as long as that lives

The system lets go of a lock however a process ends, so what is not locked was left behind.
"""

from __future__ import annotations

import contextlib
import json
import re
import secrets
import stat
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from risorius.assets.staging import locked

from ...errors import UserError
from ...files import cannot_be_written, read_text, save_text
from ...script import LONGEST_FILE, Limits, Script, parse_script, script_text

KINDS = ("script", "recording", "pose")  # the files of one window, in the order of opening
FILE_LINE = "# Its file: "
_FILE_LINE = re.compile(rf'^{FILE_LINE}(".*")$', re.MULTILINE)


@dataclass(frozen=True)
class Work:
    """What is not saved; None for what there is nothing of."""

    script: Script | None = None
    path: Path | None = None  # the file that the script was opened from or saved to
    recording: Script | None = None
    pose: Script | None = None

    def __bool__(self) -> bool:
        return any((self.script, self.recording, self.pose))

    def fits(self, scene: str, limits: Limits) -> bool:
        """Whether it is for a scene of this name and these controls."""
        scripts = [each for each in (self.script, self.recording, self.pose) if each is not None]
        with contextlib.suppress(UserError):
            for script in scripts:
                script.check(limits)
            return all(script.scene == scene for script in scripts)
        return False

    @property
    def summary(self) -> str:
        """What there is of it."""
        name = self.path.name if self.path else self.script.title if self.script else ""
        lost = {
            f"the script {name}".rstrip(): self.script,
            "a recording": self.recording,
            "a pose": self.pose,
        }
        *others, last = (what for what, script in lost.items() if script is not None)
        return f"{', '.join(others)} and {last}" if others else last


class WorkFiles:
    """The files of one window; others leave them alone until `leave` or the process's end.

    work: what is in them.
    """

    work: Work

    def __init__(self, folder: Path, name: str, lock: IO[Any]) -> None:
        self._folder, self._name, self._lock = folder, name, lock
        self.work = Work()

    @classmethod
    def new(cls, folder: Path) -> WorkFiles:
        """Files of one's own, none so far; UserError where there can be none."""
        name = f"{time.strftime('%Y%m%d-%H%M%S')}-{secrets.token_hex(3)}"
        with cannot_be_written(folder):
            folder.mkdir(parents=True, exist_ok=True)
            lock = locked(folder / f"{name}.lock")
        assert lock is not None
        return cls(folder, name, lock)

    def write(self, work: Work) -> None:
        """Keep work in place of what there is; UserError where it cannot be written."""
        before, self.work = self.work, Work()  # lest after an error something is thought to be safe
        for kind in KINDS:
            script = getattr(work, kind)
            if script is None:
                with cannot_be_written(self._file(kind)):
                    self._file(kind).unlink(missing_ok=True)
            elif script != getattr(before, kind):
                text = script_text(script)
                if kind == "script" and work.path is not None:
                    text += f"\n{FILE_LINE}{json.dumps(str(work.path.absolute()))}\n"
                save_text(self._file(kind), text)
        self.work = work

    def read(self) -> None:
        """Find the work that is there; UserError or OSError where a file is damaged."""
        texts = {
            kind: read_text(file, what="script", longest=LONGEST_FILE)
            for kind, file in self._files().items()
        }
        path = _path_in(texts.get("script", ""))
        # Named as its own file is, for error texts and as a title where it has none.
        sources = {"script": str(path or "Untitled")}
        scripts = {
            kind: parse_script(text, source=sources.get(kind, kind)) for kind, text in texts.items()
        }
        self.work = Work(path=path, **scripts)

    @property
    def time(self) -> float:
        """When it was written last [s since 1970]; 0 where there is nothing."""
        return max((file.stat().st_mtime for file in self._files().values()), default=0.0)

    def remove(self) -> None:
        """Take all of them away."""
        self.leave()
        for name in (*(f"{kind}.toml" for kind in KINDS), "lock"):
            with contextlib.suppress(OSError):
                (self._folder / f"{self._name}.{name}").unlink()

    def leave(self) -> None:
        """Let others have them."""
        self._lock.close()

    def _file(self, kind: str) -> Path:
        return self._folder / f"{self._name}.{kind}.toml"

    def _files(self) -> dict[str, Path]:
        return {kind: self._file(kind) for kind in KINDS if self._file(kind).exists()}


def left_behind(folder: Path) -> Iterator[WorkFiles]:
    """The work in a folder whose windows ended; the latest first.

    What cannot be read stays there and is passed by. Whoever does not want some leaves it.
    """
    try:
        names = {file.name.split(".")[0] for file in folder.iterdir() if file.suffix == ".toml"}
    except OSError:
        return
    for name in sorted(names, reverse=True):
        try:
            lock = locked(folder / f"{name}.lock")
            if lock is None:
                continue
            found = WorkFiles(folder, name, lock)
            found.read()
        except (OSError, UserError):
            continue
        if found.work:
            yield found
        else:
            found.remove()


def _path_in(text: str) -> Path | None:
    """The file of a script by the last line that names it; None for what can be none."""
    lines = _FILE_LINE.findall(text)
    if not lines:
        return None
    try:
        path = Path(json.loads(lines[-1]))
        return path if stat.S_ISREG(path.stat().st_mode) else None
    except FileNotFoundError:  # it went away since; saving makes it anew
        return path
    except (OSError, ValueError):
        return None
