"""Two decorators for all compiled code of this package.

`kernel` is numba's: compiled on the first call for the types that it gets, and kept in numba's
cache. `native` (native.py) is for what every frame and every start of the paper's refiner goes
through: its arguments are bound once, and later starts do without numba.

Why here: numba is untyped, and its options have to be the same everywhere. Two kernels that must
agree to the last bit (the normals at rest and the normals of a frame) may not differ in floating
point options. So no fast-math either: results do not depend on how a loop was vectorised.

Numba's cache on disk knows a kernel by the file it is written in, and freezes what it finds outside
it. So a kernel may use constants and other kernels of its own file only; everything else is handed
to it as an argument. Native ones may call kernels of other files, too: their cache knows of them. A
test holds this, because the penalty is old code after an update.

Numba is imported when the first kernel needs it: that alone takes longer than a start without it.

Serial on purpose: at the size of a face the start of a parallel region costs more than the work
(measured: two threads lose below 7 000 output triangles, and stall when a core is taken).
"""

import functools
from collections.abc import Callable
from importlib import import_module
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "boundscheck": False}
"""Of numba, for all kernels."""


class Compiled(Generic[Arguments, Result]):
    """A Python function that numba compiles; other kernels may call it."""

    def __init__(self, function: Callable[Arguments, Result]) -> None:
        functools.update_wrapper(cast(Any, self), function)
        self.py_func = cast(FunctionType, function)

    @functools.cached_property
    def dispatcher(self) -> Any:
        """Numba's own form of the function."""
        numba: Any = import_module("numba")
        _listen()
        return numba.njit(**self._options(), **OPTIONS)(self.py_func)

    def _options(self) -> dict[str, Any]:
        raise NotImplementedError

    @property
    def _numba_type_(self) -> Any:
        """How numba asks what a name means that one kernel finds in another: a function."""
        return import_module("numba").typeof(self.dispatcher)


class Kernel(Compiled[Arguments, Result]):
    """What `kernel` makes of a function."""

    def __call__(self, *arguments: Arguments.args, **keywords: Arguments.kwargs) -> Result:
        """Run the machine code for these types of arguments."""
        return cast(Result, self.dispatcher(*arguments, **keywords))

    def _options(self) -> dict[str, Any]:
        return {"cache": True}


def kernel(function: Callable[Arguments, Result]) -> Kernel[Arguments, Result]:
    """Compile `function` with numba on its first call; the machine code is cached on disk."""
    return Kernel(function)


_tell: Callable[[], object] | None = None


def on_compile(tell: Callable[[], object]) -> None:
    """Call `tell` once, just before the first kernel is compiled: it takes seconds, once.

    Later starts find the machine code on disk and are not told of. For a program that wants to say
    why it hesitates; call it before `create`.
    """
    global _tell
    _tell = tell


def say_compiling() -> None:
    """Tell whoever asked for it that a kernel is going to be compiled."""
    global _tell
    if _tell is not None:
        tell, _tell = _tell, None
        tell()


@functools.cache
def _listen() -> None:
    """Hear from numba when it compiles: only what the cache on disk does not have is compiled."""
    event: Any = import_module("numba.core.event")

    class Listener(event.Listener):  # type: ignore[misc]
        def on_start(self, event: Any) -> None:
            module = event.data["dispatcher"].py_func.__module__
            if module.startswith(f"{__package__}."):
                say_compiling()

        def on_end(self, event: Any) -> None:
            """Nothing is told of the end."""

    event.register("numba:compile", Listener())
