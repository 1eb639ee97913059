"""Array types by what they hold: kernels are compiled for these and no others."""

from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]
Indices = npt.NDArray[np.int32]
Wide = npt.NDArray[np.int64]
Small = npt.NDArray[np.uint8]
Short = npt.NDArray[np.uint16]
Flags = npt.NDArray[np.bool_]
Arrays = tuple[Any, ...]
"""What is in a named tuple of arrays, without the names.

Numba takes a plain tuple from Python in half the time. So the kernels of the paper's frame are
handed `frame[:]`, and begin by giving the names back, which costs nothing in compiled code.
"""
