"""Passes as one OpenEXR file of named channels, 32 bits each, losslessly compressed.

    depth.Z  normal.X normal.Y normal.Z  tension.stretch tension.compression     float
    triangle.ID  splits                                                          unsigned integer

Integers have no sign there: NOTHING stands for a triangle of -1, and is -1 again when it is read as
signed.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import needed

CHANNELS = {
    "depth": ("depth.Z",),
    "normal": ("normal.X", "normal.Y", "normal.Z"),
    "triangle": ("triangle.ID",),
    "splits": ("splits",),
    "tension": ("tension.stretch", "tension.compression"),
}
NOTHING = 0xFFFFFFFF


def openexr() -> Any:
    """OpenEXR's module; UserError where it is missing."""
    return needed("OpenEXR", "--passes", "passes")


def write_exr(path: Path, passes: Mapping[str, npt.NDArray[Any]]) -> None:
    """Write passes by their names (passes.py), those of CHANNELS; OSError where that fails."""
    module = openexr()
    channels = {}
    for name, images in passes.items():
        kind = np.float32 if images.dtype.kind == "f" else np.uint32
        layers = images.reshape(*images.shape[:2], -1).astype(kind)
        for k, channel in enumerate(CHANNELS[name]):
            channels[channel] = np.ascontiguousarray(layers[..., k])
    header = {"compression": module.ZIP_COMPRESSION, "type": module.scanlineimage}
    try:
        with module.File(header, channels) as file:
            file.write(str(path))
    except RuntimeError as error:  # ... image file "...". No space left on device.
        raise OSError(str(error).rpartition('". ')[2].rstrip(".")) from None
