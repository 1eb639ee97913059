"""Noise in space: the same at the same point for ever, on every machine.

Source: value noise on a lattice, its corners hashed (Perlin 1985, "An image synthesizer", in its
simplest form); the hash is the finaliser of MurmurHash3 (Appleby 2011).
"""

import numpy as np
import numpy.typing as npt

from .fields import Points, Values

Hashes = npt.NDArray[np.uint32]
AT_ONCE = 32768  # points; what is worked out on the way stays in a processor's cache
PRIMES = (np.uint32(73856093), np.uint32(19349663), np.uint32(83492791))  # Teschner et al. 2003


def _mixed(mixed: Hashes) -> Values:
    """Hashes to values -1..1 that look like chance, shape (n,)."""
    mixed = mixed ^ (mixed >> np.uint32(16))
    mixed *= np.uint32(0x85EBCA6B)
    mixed ^= mixed >> np.uint32(13)
    mixed *= np.uint32(0xC2B2AE35)
    mixed ^= mixed >> np.uint32(16)
    return np.asarray(mixed, dtype=np.float64) * 2.0**-31 - 1.0


def _cells(points: Points, size: float) -> tuple[list[Hashes], Points]:
    """The lattice cell of each point, a number for each axis, and the place in it 0..1."""
    place = points / size
    cells = np.floor(place)
    # Negative cells wrap around, as they do in C.
    numbers = cells.astype(np.int64).astype(np.uint32)
    return [numbers[:, k] * prime for k, prime in enumerate(PRIMES)], place - cells


def noise(points: Points, size: float, *, seed: int) -> Values:
    """Smooth noise of mean 0 and about -1..1 whose grains are `size` [mm] wide, shape (n,)."""
    result = np.empty(len(points))
    for start in range(0, len(points), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        result[some] = _noise(points[some], size, seed)
    return result


def _noise(points: Points, size: float, seed: int) -> Values:
    axes, part = _cells(points, size)
    part = part * part * (3.0 - 2.0 * part)
    total = np.zeros(len(points))
    for upper in np.ndindex(2, 2, 2):
        corner = np.full(len(points), seed, dtype=np.uint32)
        weight = np.ones(len(points))
        for k in range(3):
            corner ^= axes[k] + PRIMES[k] if upper[k] else axes[k]
            weight *= part[:, k] if upper[k] else 1.0 - part[:, k]
        total += weight * _mixed(corner)
    return 1.6 * total  # the mean of eight corners is narrower than one of them
