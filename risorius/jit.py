"""`njit`: numba's decorator with fixed options, and a store of its machine code.

Numba stores machine code itself (`cache=True`), but only checks one file at a time: when a kernel
changes that another file calls, old code keeps running. So code is stored in a folder that is named
by a digest of all sources of `geometry/`, `refine/`, `render/` and `sim/`, this file, and the
versions of numba and Python. After any change everything is compiled again, into a new folder. It
is `risorius/compiled-DIGEST` in the folder named by NUMBA_CACHE_DIR, or in the user's cache.

Numba reads its folder from `numba.config.CACHE_DIR` once, when it makes the store of a function.
The variable is set only during this call, so kernels of other packages in the process keep their
folder. If no folder belongs only to this user, code is compiled in each process, and one line in
the log reports this. With NUMBA_DISABLE_JIT=1 all kernels run as Python, slowly, for debuggers and
coverage. Fast-math is off unless a kernel needs it, so results do not depend on the
vectorisation of a loop.

Processes that start together share the work: one compiles a kernel, and the others wait for it and
load its code. For this a process locks one byte of the file `compiling.lock` in the folder, at a
place that the kernel's name determines. Windows has no such locks, so each process compiles there.

This file does not depend on the code that it compiles. A copy of `refine/` also needs this file.
"""

import functools
import gc
import hashlib
import importlib.util
import logging
import os
import shutil
import sys
import tempfile
import threading
import time
import zlib
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, overload

import numba
from numba.core import event
from numba.core.caching import FunctionCache
from numba.core.registry import CPUDispatcher

if sys.platform != "win32":
    import fcntl

Function = TypeVar("Function", bound=Callable[..., Any])

KERNEL_OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "nopython": True,
}
"""Options of all kernels: they release the GIL, and 1 / 0 is infinite, as in numpy.

C never calls a kernel, so numba need not compile a wrapper for it, a tenth of its work.
"""

log = logging.getLogger(__name__)
_lock = threading.Lock()
_in_lanes: set[Any] = set()
_numbas: Any = numba.config  # type checkers do not know its entries


@overload
def njit(function: Function, /) -> Function: ...


@overload
def njit(
    *, lanes: bool = False, fastmath: Collection[str] = ()
) -> Callable[[Function], Function]: ...


def njit(function: Any = None, /, *, lanes: bool = False, fastmath: Collection[str] = ()) -> Any:
    """Compile a function with numba when it is first called with new types of arguments.

    Code is stored for this package only: the dependencies of other code are unknown.

    - `lanes`: whether the compiler combines equal work on neighbouring numbers (LLVM's SLP
      vectoriser, which numba leaves out). Results are equal to the last bit.
    - `fastmath`: inexact optimisations that the compiler may use, as in numba; by default none.
    """
    options: dict[str, Any] = {"fastmath": set(fastmath)} if fastmath else {}
    if function is None:
        return functools.partial(njit, lanes=lanes, fastmath=fastmath)
    if lanes:
        _in_lanes.add(function)
    if _numbas.DISABLE_JIT:
        return function
    is_ours = function.__module__.partition(".")[0] == __package__ and not function.__closure__
    folder = cache_folder() if is_ours else None
    kernel = _Kernel(function, targetoptions={**KERNEL_OPTIONS, **options})
    if folder:
        kernel.store_in(folder)
    return kernel


@functools.cache
def cache_folder() -> Path | None:
    """The folder for machine code; None if there is no trusted one."""
    users = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    above = Path(os.environ.get("NUMBA_CACHE_DIR") or users).absolute() / "risorius"
    folder = above / f"compiled-{_digest()}"
    try:
        is_new = not folder.exists()
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = folder.lstat()
        if hasattr(os, "geteuid") and (status.st_uid != os.geteuid() or status.st_mode & 0o022):
            raise OSError("others may write into it")
        # Numba fails on a full disk; all our kernels need a tenth of this.
        free_bytes = 1 << 26
        if shutil.disk_usage(folder).free < free_bytes:
            raise OSError("the disk is full")
        tempfile.TemporaryFile(dir=folder).close()
        os.utime(folder)
    except OSError as error:
        why = error.strerror or error
        cure = "name a folder of your own in NUMBA_CACHE_DIR"
        log.warning("compiled code is not kept (%s: %s); %s", folder, why, cure)
        return None
    if is_new:
        _remove_old(above)
    return folder


def _digest() -> str:
    """Digest of everything that affects machine code, except the processor, which numba checks."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    digest.update(Path(__file__).read_bytes())
    for package in ("geometry", "refine", "render", "sim"):  # some may be missing
        found = importlib.util.find_spec(f"{__package__}.{package}")
        for folder in (found and found.submodule_search_locations) or ():
            for file in sorted(Path(folder).rglob("[!.]*.py")):  # no hidden files of editors
                digest.update(str(file.relative_to(folder)).encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def _remove_old(above: Path) -> None:
    """Remove folders of other digests, except those used last."""
    with suppress(OSError):
        used = {folder: folder.stat().st_mtime for folder in above.glob("compiled-*")}
        most_folders = 8  # number of folders of other digests that are kept at any age
        unused_seconds = 24 * 3600.0  # age after which further folders are removed
        for folder in sorted(used, key=used.__getitem__, reverse=True)[most_folders:]:
            if used[folder] < time.time() - unused_seconds:
                shutil.rmtree(folder, ignore_errors=True)


class _Kernel(CPUDispatcher):
    """A compiled function, with separate machine code for calls from Python and from kernels.

    For Python, numba compiles a wrapper that converts each array of each argument, a fifth of its
    work. Other kernels call the function directly and need no wrapper.
    """

    folder: Path | None = None  # for machine code

    @functools.cached_property
    def _without_wrapper(self) -> Any:
        """The function as other kernels call it."""
        options = {**self.targetoptions, "no_cpython_wrapper": True}
        kernel: Any = CPUDispatcher(self.py_func, targetoptions=options)
        if self.folder:
            kernel._cache = _SharedCache(self.py_func, self.folder / "without_wrapper")
        return kernel

    def store_in(self, folder: Path) -> None:
        """Store the machine code in a folder."""
        self.folder = folder
        self._cache = _SharedCache(self.py_func, folder)

    def get_call_template(self, *types: Any) -> Any:
        """Compile the function for a call in another kernel; return numba's type of the call."""
        return self._without_wrapper.get_call_template(*types)

    def get_overload(self, signature: Any) -> Any:
        """Return the code that another kernel calls."""
        return self._without_wrapper.get_overload(signature)


class _SharedCache(FunctionCache):
    """Numba's store of a kernel's machine code, with a lock between loading and saving.

    Numba loads code, compiles it if the store has none, and saves it. The lock is held during the
    last two steps. It belongs to the process, which can take it twice, and ends with the process.
    `_Compilation` unlocks a kernel that does not compile, because numba saves nothing then.
    """

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        with _lock:
            before, _numbas.CACHE_DIR = _numbas.CACHE_DIR, str(folder)
            try:
                super().__init__(function)
            finally:
                _numbas.CACHE_DIR = before
        self._folder = folder
        name = f"{function.__module__}.{function.__qualname__}"
        self._place = zlib.crc32(name.encode())

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Load code for a signature; if another process compiles the kernel, wait for it."""
        found = super().load_overload(signature, target)
        if found is None and self._is_locked():
            found = super().load_overload(signature, target)
            if found is not None:
                self.unlock()
        return found

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Save the code of a signature, for which other processes may wait."""
        try:
            super().save_overload(signature, compiled)
        finally:
            self.unlock()

    def unlock(self) -> None:
        """Unlock the kernel, also if it is not locked."""
        if sys.platform != "win32":
            with suppress(OSError):
                fcntl.lockf(_lock_file(self._folder), fcntl.LOCK_UN, 1, self._place)

    def _is_locked(self) -> bool:
        """Lock the kernel; return whether this succeeded."""
        if sys.platform == "win32":
            return False
        # A process that is paused while it compiles must not stop others for ever.
        most_seconds = 120.0
        deadline = time.monotonic() + most_seconds
        while time.monotonic() < deadline:
            try:
                lock = fcntl.LOCK_EX | fcntl.LOCK_NB
                fcntl.lockf(_lock_file(self._folder), lock, 1, self._place)
                return True
            except (BlockingIOError, PermissionError):
                time.sleep(0.02)
            except OSError:  # a file system without locks
                return False
        return False


@functools.cache
def _lock_file(folder: Path) -> int:
    """Open the file of locks; it stays open, because closing it would release every lock."""
    return os.open(folder / "compiling.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)


class _Compilation(event.Listener):
    """Logs each kernel of this package that is compiled, and sets numba's compiler options for it.

    While numba compiles a function, it also compiles the functions that this function calls. Python
    collects no garbage meanwhile, which saves a tenth of the time.
    """

    def __init__(self) -> None:
        self._settings: list[int] = []
        self._has_paused_collector = False

    def on_start(self, event: event.Event) -> None:
        """Log a kernel and set its options; numba calls this before it compiles a function."""
        if not self._settings and gc.isenabled():
            gc.disable()
            self._has_paused_collector = True
        function = event.data["dispatcher"].py_func
        self._settings.append(_numbas.SLP_VECTORIZE)
        if (function.__module__ or "").partition(".")[0] == __package__:
            _numbas.SLP_VECTORIZE = int(function in _in_lanes)
            log.info("compiling %s.%s", function.__module__, function.__qualname__)

    def on_end(self, event: event.Event) -> None:
        """Restore the earlier settings, and unlock a kernel that could not be compiled."""
        _numbas.SLP_VECTORIZE = self._settings.pop()
        if not self._settings and self._has_paused_collector:
            gc.enable()
            self._has_paused_collector = False
        kernel = event.data["dispatcher"]
        has_failed = tuple(event.data["args"]) not in kernel.overloads
        cache = getattr(kernel, "_cache", None)
        if has_failed and isinstance(cache, _SharedCache):
            cache.unlock()


event.register("numba:compile", _Compilation())
