"""Array types by their content, with the number of bits in the name."""

from typing import Any

import numpy as np
import numpy.typing as npt

Floats64 = npt.NDArray[np.float64]
Floats32 = npt.NDArray[np.float32]
Integers = npt.NDArray[np.integer[Any]]  # of any width
Integers64 = npt.NDArray[np.int64]
Integers32 = npt.NDArray[np.int32]
Unsigned32 = npt.NDArray[np.uint32]
Unsigned16 = npt.NDArray[np.uint16]
Unsigned8 = npt.NDArray[np.uint8]
Flags = npt.NDArray[np.bool_]
