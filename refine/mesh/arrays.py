"""Array types by their content: kernels are compiled for these and no others."""

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
