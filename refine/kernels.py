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
from typing import ParamSpec, TypeVar

import numba

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def kernel(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Compile `function` with numba on its first call; the machine code is cached on disk."""
    compiled: Callable[Arguments, Result] = numba.njit(
        cache=True, nogil=True, error_model="numpy", boundscheck=False
    )(function)
    return compiled
