"""One decorator for all compiled code of this package.

Why here: numba is untyped, and its options have to be the same everywhere. Two kernels that must
agree to the last bit (the normals at rest and the normals of a frame) may not differ in floating
point options. So no fast-math either: results do not depend on how a loop was vectorised.

The cache on disk knows a kernel by the file it is written in, and freezes what it finds outside it.
So a kernel may use constants and other kernels of its own file only; everything else is handed to
it as an argument. A test holds this, because the penalty is old code after an update.

Serial on purpose: at the size of a face the start of a parallel region costs more than the work
(measured: two threads lose below 7 000 output triangles, and stall when a core is taken).
"""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba
from numba.core import event

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def kernel(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Compile `function` with numba on its first call; the machine code is cached on disk."""
    compiled: Callable[Arguments, Result] = numba.njit(
        cache=True, nogil=True, error_model="numpy", boundscheck=False
    )(function)
    return compiled


class _FirstCompilation(event.Listener):
    """Tells once that a kernel of this package has to be compiled."""

    def __init__(self, tell: Callable[[], object]) -> None:
        self._tell: Callable[[], object] | None = tell

    def on_start(self, event: Any) -> None:
        """Hear of a compilation: only kernels that the cache on disk does not have come here."""
        module = event.data["dispatcher"].py_func.__module__
        if self._tell is not None and module.startswith(f"{__package__}."):
            tell, self._tell = self._tell, None
            tell()

    def on_end(self, event: Any) -> None:
        """Nothing is told of the end."""


def on_compile(tell: Callable[[], object]) -> None:
    """Call `tell` once, just before the first kernel is compiled: it takes seconds, once.

    Later starts find the machine code on disk and are not told of. For a program that wants to say
    why it hesitates; call it before `create`.
    """
    event.register("numba:compile", _FirstCompilation(tell))  # type: ignore[no-untyped-call]
