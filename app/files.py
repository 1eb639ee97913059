"""Reading of plain files, and atomic writing of files and folders.

Only plain files are read: a pipe without a writer would make the program wait forever, and a device
like /dev/zero has no end. An output is written into a temporary folder, and moved to its place when
it is complete.
"""

from __future__ import annotations

import contextlib
import difflib
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from .errors import UserError
from .staging import StagingFolder, is_staging_folder
from .stopping import cleaned_up_if_stopped, delay_signals
from .text import as_text


class NoSuchFileError(UserError):
    """There is no file to read."""


def read_text(path: Path, *, what: str, longest: int) -> str:
    """Read a UTF-8 file, with or without a byte order mark, of at most `longest` bytes.

    what: the kind of file, for error texts ("script"). Raises UserError for an unusable file, and
    its subclass NoSuchFileError for a missing one.
    """
    try:
        return read_bytes(path, what=what, longest=longest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        where = f"byte {error.start} is {error.object[error.start]:#04x}"
        raise UserError(
            f"{path}: is not text in UTF-8 ({where}); save the {what} in this encoding"
        ) from None


def _similar(path: Path) -> str:
    """Return the end of an error text that suggests a similar file name, or ""."""
    try:
        names = [each.name for each in path.parent.iterdir() if each.is_file()]
    except (OSError, ValueError):
        return ""
    near = difflib.get_close_matches(path.name, names, n=1, cutoff=0.8)
    return f"; did you mean {path.with_name(near[0])}?" if near else ""


def read_bytes(path: Path, *, what: str, longest: int, first: int | None = None) -> bytes:
    """Read a plain file of at most `longest` bytes, or only its `first` bytes.

    Raises the same errors as `read_text`.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            kind = "folder" if path.is_dir() else "pipe or a device"
            raise UserError(f"{path}: is a {kind}, not a file; a {what} is a plain file")
        if status.st_size > longest:
            most = f"{longest >> 20} MB" if longest >= 2**20 else f"{longest >> 10} kB"
            raise UserError(f"{path}: is too long; a {what} may have {most}")
        with path.open("rb") as file:
            return file.read(longest if first is None else first)
    except FileNotFoundError:
        raise NoSuchFileError(f"{path}: no such {what}{_similar(path)}") from None
    except (OSError, ValueError) as error:  # an impossible name is a ValueError
        why = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: cannot be read: {why}") from None


@contextlib.contextmanager
def written_atomically(target: Path) -> Iterator[Path]:
    """Yield a path beside `target`; it is renamed to `target` if the block has no error.

    Other files that the block writes beside this path are moved too. If the target is a symbolic
    link, the file replaces the link, as with `mv`: another user may have put the link into a
    shared folder. Raises UserError if a file cannot be written, in the block or after it.
    """
    check_links(target)
    parent = Path(os.path.realpath(target.parent))
    with cannot_be_written(target):
        parent.mkdir(parents=True, exist_ok=True)
    with temporary_folder(target, parent) as folder, cannot_be_written(target):
        part = folder / target.name
        yield part
        with delay_signals():
            for each in (*(item for item in folder.iterdir() if item != part), part):
                os.replace(each, parent / each.name)


@contextlib.contextmanager
def named_in_text(target: Path) -> Iterator[Path]:
    """Yield a path to write `target` to, for libraries that only take names in UTF-8.

    The path is `target` itself if it is valid UTF-8. Otherwise the file is written into the
    system's temporary folder, and moved after the block.
    """
    if as_text(target) == str(target):
        yield target
        return
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / f"part{as_text(target.suffix)}"
        yield part
        shutil.move(part, target)


@contextlib.contextmanager
def folder_atomically(target: Path, own: re.Pattern[str], *, overwrite: bool) -> Iterator[Path]:
    """Yield a folder; after the block all its files move into the folder `target` together.

    own: pattern of the names of our files. overwrite: replace all older files with such names;
    other files stay. Without it, raises UserError if the target is not empty.
    """
    check_folder(target, overwrite=overwrite)
    is_new = not target.exists()

    def give_up() -> None:
        with contextlib.suppress(OSError):  # the target is not empty
            target.rmdir()

    with contextlib.ExitStack() as stack:
        if is_new:
            stack.enter_context(cleaned_up_if_stopped(give_up))
            stack.callback(give_up)
            with cannot_be_written(target):
                target.mkdir(parents=True)
        temporary = stack.enter_context(temporary_folder(target, target))
        yield temporary
        with delay_signals(), cannot_be_written(target):  # no interruption between the two loops
            for old in target.iterdir():
                if own.fullmatch(old.name):
                    old.unlink()
            for new in temporary.iterdir():
                os.replace(new, target / new.name)


def check_folder(target: Path, *, overwrite: bool) -> None:
    """Raise UserError if a folder for many files cannot be written, or is not empty.

    A link to a folder counts as that folder.
    """
    check_links(target)
    with cannot_be_written(target):
        is_empty = not target.exists() or all(map(is_staging_folder, target.iterdir()))
    if not is_empty and not overwrite:
        raise UserError(
            f"{target}: exists and is not empty; choose another folder, or add --overwrite"
        )


@contextlib.contextmanager
def temporary_folder(target: Path, parent: Path) -> Iterator[Path]:
    """Make a folder in `parent`, and remove it after the block; errors name `target`."""
    temporary = StagingFolder(parent)
    with cleaned_up_if_stopped(temporary.remove), contextlib.ExitStack() as stack:
        with cannot_be_written(target):
            folder = stack.enter_context(temporary)
        yield folder


@contextlib.contextmanager
def cannot_be_written(target: Path) -> Iterator[None]:
    """Turn the system's error when writing `target` into a UserError that names it."""
    try:
        yield
    except OSError as error:
        raise UserError(f"{target}: cannot be written: {error.strerror or error}") from None


def check_links(target: Path) -> None:
    """Raise UserError if the links of a path form a circle."""
    with cannot_be_written(target):
        if os.path.islink(os.path.realpath(target)):
            raise UserError(f"{target}: is a link that leads back to itself; choose another name")


def entry_of(path: Path) -> str:
    """Resolve the links in a path, except a link to a file at its end."""
    if path.is_dir():
        return os.path.realpath(path)
    return os.path.join(os.path.realpath(path.parent), path.name)


def check_file(target: Path) -> None:
    """Raise UserError, before any work is done, if no file of this name can be written."""
    check_links(target)
    with cannot_be_written(target):
        if target.is_dir():
            raise UserError(f"{target}: is a folder; choose another name for the file")
        if target.exists() and not target.is_file() and not target.is_symlink():
            raise UserError(f"{target}: is a device, not a file; choose another name")
        parents = Path(entry_of(target)).parents
        parent = next(parent for parent in parents if os.path.lexists(parent))
        with temporary_folder(target, parent) as folder:
            (folder / target.name).touch()


def save_text(target: Path, text: str) -> None:
    """Write a text file, UTF-8; raises UserError if it cannot be written."""
    check_file(target)
    with written_atomically(target) as part:
        part.write_text(text, encoding="utf-8")


def check_apart(outputs: Sequence[Path | None], inputs: Sequence[Path | None]) -> None:
    """Raise UserError if two outputs are one file, or if an output would replace an input."""
    written: set[str] = set()
    read: set[str] = set()
    for path in inputs:
        if path is not None:  # `realpath`, unlike `resolve`, accepts links to themselves
            read |= {entry_of(path), os.path.realpath(path)}
    for path in outputs:
        if path is None:
            continue
        entry = entry_of(path)
        if entry in read:
            raise UserError(
                f"{path}: is both an input and an output; choose another name for the output"
            )
        if entry in written:
            raise UserError(f"{path}: is the name of two outputs; rename one of them")
        written.add(entry)
