"""`njit`: numba's decorator, with one set of options and a cache on disk that can be relied on.

Numba can keep machine code itself (`cache=True`), but its cache looks at one file at a time: when a
kernel changes that is called from another file, old code goes on running. It also trusts whatever
lies in its folder, and gives up where no folder can be written, where the disk is full, or where a
file was torn. So here numba compiles, and this file keeps what it made:

    valid    for all source files of the kernel's package together, these options, the versions of
             numba and Python, and the processor; each file has a check sum
    of       kernels of this distribution; those of other programs are compiled in each process
    where    the first of: the folder named by NUMBA_CACHE_DIR, beside the code, the user's cache
    trusted  only a folder that belongs to this user, that nobody else may write, move or replace
    else     code is compiled in each process anew, and a warning in the log says so once; so it is
             where numba's insides, which this file uses, are not those that it knows
    waiting  processes that start together let one compile, kernel by kernel, and read what it wrote

Results do not depend on how a loop was vectorised: there is no fast-math unless a kernel asks for
it. With NUMBA_DISABLE_JIT=1 all kernels run as the Python that they are written in, slowly, for
debuggers and coverage.

This file knows nothing of what it compiles. Somebody who lifts `refine/` out takes it along.
"""

import functools
import hashlib
import importlib.util
import logging
import operator
import os
import pickle
import platform
import stat
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, overload

import numba

try:
    import fcntl
except ImportError:  # Windows: nobody waits, and two processes may do the same work
    fcntl = None  # type: ignore[assignment]

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
"""Of all kernels: other threads may run meanwhile, and 1 / 0 is infinite as it is in numpy."""
PACKAGES = (f"{__package__}.refine", f"{__package__}.sim")
"""Where kernels lie that call one another. Those of other packages may call any of them."""
INSIDES = (
    "codegen.CPUCodegen.magic_tuple",
    "compiler.CompileResult._rebuild",
    "compiler.CompileResult._reduce",
    "serialize.dumps",
)
"""What keeps code uses of `numba.core`, beside `_cache` of dispatchers; all of it is private."""
PATIENCE = 30.0
"""Seconds to wait for another process that compiles; the slowest kernel takes a few."""
PAUSE = 0.02
"""Seconds between two looks at whether it is done."""
DIGEST = 32
"""Bytes of a check sum; a file begins with what it is valid for, and that of the code."""

log = logging.getLogger(__name__)


@overload
def njit(function: Function, /) -> Function: ...


@overload
def njit(*, fastmath: set[str]) -> Callable[[Function], Function]: ...


def njit(function: Any = None, /, **options: Any) -> Any:
    """Compile a function with numba when it is first called with new types of arguments.

    `fastmath`: liberties that the compiler may take, as in numba; none if it is left out.
    """
    if function is None:
        return functools.partial(_compiled, **options)
    return _compiled(function)


def _compiled(function: Callable[..., Any], **options: Any) -> Any:
    dispatcher = numba.njit(**OPTIONS, **options)(function)
    # Of other code nobody knows what it depends on; nor what a function has closed over.
    is_ours = function.__module__.partition(".")[0] == __package__ and not function.__closure__
    if is_ours and not getattr(numba.config, "DISABLE_JIT", 0):
        if _are_insides_known(dispatcher):
            with suppress(OSError):  # without a source nothing tells when stored code becomes old
                dispatcher._cache = CodeCache(function, repr(sorted(options.items())))
        else:
            _warn_not_cached(f"numba {numba.__version__} is not known", "install another")
    return dispatcher


def _are_insides_known(dispatcher: Any) -> bool:
    try:
        operator.attrgetter(*INSIDES)(numba.core)
    except AttributeError:
        return False
    return hasattr(dispatcher, "_cache")


class CodeCache:
    """The machine code of one kernel on disk, in the form in which numba asks for a cache.

    Numba calls it while it holds the lock of its compiler, so one thread at a time.
    """

    def __init__(self, function: Callable[..., Any], options: str) -> None:
        name = f"{function.__module__}.{function.__qualname__}"
        self._name = name.replace("<", "").replace(">", "")  # Windows allows no file of such a name
        # Of the sources as they are now: what is edited later is not what gets compiled.
        sources = (_digest_of_packages(function.__module__), _digest(function.__code__.co_filename))
        self._made_of = f"{options} {sources}"

    @property
    def cache_path(self) -> str:
        """The folder; empty if there is none."""
        return str(cache_folder() or "")

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return compiled code for these types of arguments, None if it has to be made."""
        target_context.refresh()
        stored = self._read(sig, target_context)
        if stored is None:
            log.info("compiling %s", self._name)
            if _wait_to_compile(self._name):
                stored = self._read(sig, target_context)  # which the other process has made
                if stored is not None:
                    _done(self._name)
        return stored

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write compiled code; other processes see the whole file or none."""
        folder = cache_folder()
        if folder is None:
            _warn_not_cached("there is no folder that belongs to this user alone")
            return
        code = numba.core.serialize.dumps(data._reduce())
        content = self._stamp(sig, data.codegen) + hashlib.sha256(code).digest() + code
        try:
            _write(folder / self._file(sig), content)
        except OSError as error:
            _warn_not_cached(f"{error.filename2 or error.filename or folder}: {error.strerror}")
        _done(self._name)

    def _read(self, sig: Any, target_context: Any) -> Any:
        folder = cache_folder()
        if folder is None:
            return None
        try:
            content = _content(folder / self._file(sig))
        except OSError:
            return None
        stamp, check, code = content[:DIGEST], content[DIGEST : 2 * DIGEST], content[2 * DIGEST :]
        if stamp != self._stamp(sig, target_context.codegen()):
            return None
        if check != hashlib.sha256(code).digest():
            return None
        return numba.core.compiler.CompileResult._rebuild(target_context, *pickle.loads(code))

    def _file(self, sig: Any) -> str:
        return f"{self._name}.{hashlib.sha256(str(sig).encode()).hexdigest()[:16]}.code"

    def _stamp(self, sig: Any, codegen: Any) -> bytes:
        return hashlib.sha256(f"{sig} {codegen.magic_tuple()} {self._made_of}".encode()).digest()

    def enable(self) -> None:
        """Part of numba's interface; this cache is always on."""

    def disable(self) -> None:
        """Part of numba's interface; this cache is always on."""

    def flush(self) -> None:
        """Part of numba's interface; files that are not valid any more are written over."""


@functools.cache
def _digest(file: str) -> str:
    """Digest of a kernel's own file, which need not be in one of these packages."""
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


def _digest_of_packages(module: str) -> str:
    """Digest of all that code of a module depends on but its file: sources, options, versions."""
    own = ".".join(module.split(".")[:2])
    return _digest_of_sources(*([own] if own in PACKAGES else PACKAGES))


@functools.cache
def _digest_of_sources(*packages: str) -> str:
    digest = hashlib.sha256(repr(sorted(OPTIONS.items())).encode())
    digest.update(f"{numba.__version__} {sys.version} {platform.machine()}".encode())
    digest.update(Path(__file__).read_bytes())
    for package in packages:
        found = importlib.util.find_spec(package)
        for folder in (found and found.submodule_search_locations) or ():
            for file in sorted(Path(folder).rglob("*.py")):
                digest.update(str(file.relative_to(folder)).encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()


@functools.cache
def cache_folder() -> Path | None:
    """The folder that machine code is stored in; None if there is none that can be trusted."""
    here = Path(__file__).resolve().parent
    own = f"{here.name}-{hashlib.sha256(str(here).encode()).hexdigest()[:12]}"
    folders = [here / "__pycache__" / "machine_code"]
    if os.environ.get("NUMBA_CACHE_DIR"):
        folders.insert(0, Path(os.environ["NUMBA_CACHE_DIR"]) / own)
    users = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(users):  # a user without a home has none
        folders.append(Path(users) / "risorius" / own)
    return next((folder for folder in folders if _is_ours(folder)), None)


def _is_ours(folder: Path) -> bool:
    """Whether a folder, made if need be, is this user's, closed to others, and can be written.

    Nobody else may be able to put another in its place, either: in folders above that others may
    write, only the owner of a thing may move it (the sticky bit, as /tmp has it).
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if hasattr(os, "geteuid"):
            found, user = folder.lstat(), os.geteuid()
            if not stat.S_ISDIR(found.st_mode) or found.st_uid != user or found.st_mode & 0o022:
                return False
            for above in (each.stat() for each in folder.resolve().parents):
                if above.st_uid not in (user, 0):
                    return False
                if above.st_mode & 0o022 and not above.st_mode & stat.S_ISVTX:
                    return False
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _content(file: Path) -> bytes:
    """What is in a file of this user's; OSError for anything else, like a pipe that never ends."""
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0)
    with open(os.open(file, flags | getattr(os, "O_BINARY", 0)), "rb") as opened:
        found = os.fstat(opened.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise OSError(f"{file}: is no plain file")
        if hasattr(os, "geteuid") and found.st_uid != os.geteuid():
            raise OSError(f"{file}: belongs to somebody else")
        return opened.read()


def _write(file: Path, content: bytes) -> None:
    """Write a file in one step; nothing is left behind where that fails."""
    number, name = tempfile.mkstemp(dir=file.parent, prefix=".", suffix=".part")
    try:
        with os.fdopen(number, "wb") as part:
            part.write(content)
        os.replace(name, file)
    except BaseException:
        with suppress(OSError):
            os.unlink(name)
        raise


@functools.cache
def _warn_not_cached(why: str, cure: str = "name a folder of your own in NUMBA_CACHE_DIR") -> None:
    log.warning("compiled code is not kept (%s), so every start compiles again; %s", why, cure)


_lock: Any = None
"""The open file by which this process keeps others from compiling the same."""
_compiling = ""
"""The kernel it was taken for; those that this one calls are compiled under the same lock."""


def _wait_to_compile(name: str) -> bool:
    """Wait until no other process compiles code for this folder; whether there was one."""
    global _lock, _compiling
    folder = cache_folder()
    if folder is None or fcntl is None or _compiling:
        return False
    try:
        if _lock is None:
            flags = os.O_RDWR | os.O_CREAT | os.O_NONBLOCK | os.O_NOFOLLOW
            _lock = open(os.open(folder / "lock", flags, 0o600), "rb")
        has_waited, patience = False, PATIENCE
        while True:
            try:
                fcntl.flock(_lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                _compiling = name
                return has_waited
            except BlockingIOError:
                has_waited = True
            if patience <= 0.0:
                return True
            time.sleep(PAUSE)
            patience -= PAUSE
    except OSError:
        return False  # a file system without locks: both compile


def _done(name: str) -> None:
    """Let others compile, if `name` is what they wait for."""
    global _compiling
    if name == _compiling:
        _compiling = ""
        with suppress(OSError):
            fcntl.flock(_lock, fcntl.LOCK_UN)
