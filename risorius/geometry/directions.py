"""Directions of vectors."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .arrays import Floats64


def unit_vectors(vectors: npt.NDArray[Any], least: float = 1e-12) -> Floats64:
    """Scale vectors, shape (..., k), to length 1; zero vectors stay zero.

    least: vectors shorter than this are divided by it, so their length stays below 1.
    """
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(lengths, least))
