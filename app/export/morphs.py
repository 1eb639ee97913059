"""Motion as morph targets: few shapes, whose weighted sum is where the vertices are in each frame.

A singular value decomposition gives the shapes that leave the least error on average. What counts
is the largest, so vertices that are farthest off count more, and it is done again, which saves a
third of the shapes (after Lawson 1961, "Contributions to the theory of linear least maximum
approximation").

Readers such as Blender cut weights off at 0, and their sliders at 1. Weights are brought between
the two by a shift, which is the same in all frames: its sum is one more target, always at 1. A
second target for the other direction of each shape would do as well, and take twice as many.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
TOLERANCE = 0.098  # [mm] off at most; what single precision adds stays below 0.1
MOST_TARGETS = 250  # some readers count them in a byte
ROUNDS = 8  # of weighing vertices: more save hardly a shape
MOST_SAVED = 15  # shapes in one of them
LEAST_WEIGHING = 0.03  # of a vertex in one round against the one that is farthest off
NOTHING = 1e-6  # [mm] a target that moves no vertex so far is left out
LEAST_SQUARE = 1e-13  # of a component against the sum of all; less is rounding
AT_ONCE = 256  # frames that are in double precision at once, so that memory stays small


@dataclass(frozen=True)
class Morphs:
    """Shapes to add, and how much of each in every frame.

    targets: how far each vertex is moved at weight 1, shape (K, V, 3).
    weights: 0..1, shape (N, K).
    error: of any vertex in any frame [unit of the targets].
    """

    targets: Floats
    weights: Floats
    error: float


def decompose(
    moved: Floats | Singles, tolerance: float = TOLERANCE, most: int = MOST_TARGETS
) -> Morphs:
    """The fewest targets found whose weighted sum is never farther off than `tolerance`.

    moved: of each vertex from rest in each frame, shape (N, V, 3), in the unit of `tolerance`.
    Where `most` targets do not suffice, the error is larger.
    """
    curves, shapes = _components(moved.reshape(len(moved), -1))
    limit = min(len(shapes), most - 1)
    weighing = np.ones(moved.shape[1])
    found: list[Morphs] = []
    low, high = 0, limit
    for _ in range(ROUNDS):
        weighed = shapes * np.repeat(weighing, 3)
        mixing = np.linalg.eigh(weighed @ weighed.T)[1][:, ::-1][:, :limit]
        mixed_curves, mixed_shapes = curves @ mixing, mixing.T @ shapes
        while low < high:
            count = (low + high) // 2
            off = _farthest(moved, mixed_curves[:, :count], mixed_shapes[:count])
            low, high = (low, count) if off.max() <= tolerance else (count + 1, high)
        found.append(_shifted(moved, mixed_curves[:, :high], mixed_shapes[:high]))
        fewer = max(high - 1, 0)
        left = _farthest(moved, mixed_curves[:, :fewer], mixed_shapes[:fewer])
        weighing *= np.sqrt(np.maximum(left / max(left.max(), NOTHING), LEAST_WEIGHING))
        weighing /= weighing.max()
        low = max(high - MOST_SAVED, 0)
    return min(found, key=lambda each: (max(each.error, tolerance), len(each.targets)))


def follow(weights: Floats, changes: Iterator[Floats]) -> Floats:
    """What other values of the vertices add at weight 1, such as normals, as near as it gets.

    weights: shape (N, K). changes: from rest, AT_ONCE frames after the other, each of shape (n, V,
    3). Returns shape (K, V, 3).
    """
    inverse = np.linalg.pinv(weights, rcond=1e-6)
    parts = zip(parts_of(len(weights)), changes, strict=True)
    shares = (np.tensordot(inverse[:, some], part, 1) for some, part in parts)
    return np.asarray(functools.reduce(np.add, shares))


def parts_of(count: int) -> Iterator[slice]:
    """So many frames, or whatever there is much of, AT_ONCE after the other."""
    return (slice(begin, begin + AT_ONCE) for begin in range(0, count, AT_ONCE))


def _components(rows: Floats | Singles) -> tuple[Floats, Floats]:
    """Curves (N, r) of unit length and shapes (r, 3 V) whose product is the rows (N, 3 V).

    What is left away is less than rounding. The squares of the rows are decomposed, those of the
    shorter side, so that a clip of ten minutes takes seconds.
    """
    is_long = len(rows) > rows.shape[1]
    tall = rows if is_long else rows.T
    products = np.zeros((tall.shape[1], tall.shape[1]))
    for some in parts_of(len(tall)):
        part = tall[some].astype(np.float64)
        products += part.T @ part
    least = max(LEAST_SQUARE * np.trace(products), NOTHING**2)
    # Transposed, since what LAPACK overwrites is stored by columns; else it is copied.
    squares, vectors = scipy.linalg.eigh(
        products.T, overwrite_a=True, subset_by_value=(least, np.inf)
    )
    vectors, lengths = vectors[:, ::-1], np.sqrt(squares[::-1])
    others = np.empty((len(tall), len(lengths)))
    for some in parts_of(len(tall)):
        others[some] = tall[some] @ vectors
    if is_long:
        others /= lengths
        return others, (vectors * lengths).T
    return vectors, others.T


def _farthest(moved: Floats | Singles, curves: Floats, shapes: Floats) -> Floats:
    """How far off the sum of the shapes is at most at each vertex, shape (V,)."""
    farthest = np.zeros(moved.shape[1])
    for some in parts_of(len(moved)):
        off = (curves[some] @ shapes).reshape(-1, *moved.shape[1:]) - moved[some]
        farthest = np.maximum(farthest, np.einsum("nvc,nvc->nv", off, off).max(axis=0))
    return np.sqrt(farthest)


def _shifted(moved: Floats | Singles, curves: Floats, shapes: Floats) -> Morphs:
    """The sum of shapes (k, 3 V) times curves (N, k), by weights from 0 to 1."""
    signs = np.where(curves.max(axis=0) >= -curves.min(axis=0), 1.0, -1.0)
    curves, shapes = curves * signs, shapes * signs[:, None]
    lowest = np.minimum(curves.min(axis=0), 0.0)
    lengths = curves.max(axis=0) - lowest
    targets = np.vstack([lowest @ shapes, lengths[:, None] * shapes])
    shifted = (curves - lowest) / np.where(lengths > 0.0, lengths, 1.0)
    weights = np.column_stack([np.ones(len(moved)), np.clip(shifted, 0.0, 1.0)])
    kept = np.abs(targets).max(axis=1, initial=0.0) > NOTHING
    targets, weights = targets[kept], weights[:, kept]
    error = float(_farthest(moved, weights, targets).max())
    return Morphs(targets.reshape(-1, *moved.shape[1:]), weights, error)
