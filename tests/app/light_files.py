"""Files of light maps for tests."""

from pathlib import Path

import numpy as np

HEADER = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 64\n"


def pixels():
    """A sky that darkens downward, with a sun 60 times as bright."""
    light = np.linspace(1.0, 0.25, 32)[:, None, None] * np.array([0.5, 0.75, 1.0])
    light = np.broadcast_to(light, (32, 64, 3)).copy()
    light[6:9, 40:44] = 60.0
    return light


def rgbe(light):
    """Pixels with shared exponents (RGBE), (H, W, 4)."""
    _, exponent = np.frexp(light.max(axis=-1))
    mantissa = light * np.ldexp(256.0, -exponent)[..., None]
    return np.concatenate([mantissa, exponent[..., None] + 128], axis=-1).astype(np.uint8)


def write_map(path: Path) -> Path:
    """Write the sky as a Radiance file; return its path."""
    path.write_bytes(HEADER + rgbe(pixels()).tobytes())
    return path
