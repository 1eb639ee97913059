"""Decomposes motion into morph targets: weighted sums of a few shapes give each frame's vertices.

A singular value decomposition gives the shapes with the least mean error. Here the largest error
matters, so vertices with large errors get more weight, and the decomposition is repeated. This
saves a third of the shapes (after Lawson 1961, "Contributions to the theory of linear least maximum
approximation").

Readers such as Blender clamp weights at 0, and their sliders at 1. So each weight is shifted and
scaled to 0..1, and one more target with weight 1 subtracts the shifts. A second target for the
opposite direction of each shape would also work, but would double the number of targets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from risorius.geometry.arrays import Floats64

MORPH_TOLERANCE = 0.098  # [mm]: largest error; with single precision it stays below 0.1
LEAST_TARGET_MOTION = 1e-6  # [mm]: a target that moves every vertex by less is left out


@dataclass(frozen=True)
class Morphs:
    """Morph targets and their weights in every frame.

    targets: displacement of each vertex at weight 1, shape (K, V, 3).
    weights: 0..1, shape (N, K).
    error: largest error of a vertex in any frame [unit of the targets].
    """

    targets: Floats64
    weights: Floats64
    error: float


def decompose(moved: Floats64, most: int = 198) -> Morphs:
    """Return few targets with an error of at most MORPH_TOLERANCE.

    moved: displacements of each vertex from rest in each frame [mm], shape (N, V, 3). If `most`
    targets do not suffice, the error is larger. Some readers count targets in a byte, and the 52
    named targets also count.
    """
    curves, lengths, shapes = np.linalg.svd(moved.reshape(len(moved), -1), full_matrices=False)
    # Components below this share of the largest component are rounding errors.
    rank = int((lengths > max(3e-7 * lengths.max(initial=0.0), LEAST_TARGET_MOTION)).sum())
    curves = curves[:, :rank]
    shapes = lengths[:rank, None] * shapes[:rank]
    limit = min(rank, most - 1)
    weighing = np.ones(moved.shape[1])
    found: list[Morphs] = []
    low = 0
    high = limit
    # More than 8 rounds of weighting save hardly any shape.
    for _ in range(8):
        weighed = shapes * np.repeat(weighing, 3)
        _, vectors = np.linalg.eigh(weighed @ weighed.T)
        mixing = vectors[:, ::-1][:, :limit]  # largest eigenvalues first
        mixed_curves = curves @ mixing
        mixed_shapes = mixing.T @ shapes
        while low < high:
            count = (low + high) // 2
            off = _largest_errors(moved, mixed_curves[:, :count], mixed_shapes[:count])
            if off.max() <= MORPH_TOLERANCE:
                high = count
            else:
                low = count + 1
        found.append(_targets_with_weights(moved, mixed_curves[:, :high], mixed_shapes[:high]))
        fewer = max(high - 1, 0)
        left = _largest_errors(moved, mixed_curves[:, :fewer], mixed_shapes[:fewer])
        # In each round, a vertex keeps at least the root of 0.03 of its relative weight.
        ratio = left / max(left.max(), LEAST_TARGET_MOTION)
        weighing *= np.sqrt(np.maximum(ratio, 0.03))
        weighing /= weighing.max()
        low = max(high - 15, 0)  # a round saves at most 15 shapes
    return min(found, key=lambda each: (max(each.error, MORPH_TOLERANCE), len(each.targets)))


def follow(weights: Floats64, changes: Floats64) -> Floats64:
    """Fit targets for other values of the vertices, such as normals, to the same weights.

    weights: shape (N, K). changes: differences from rest, shape (N, V, 3). Returns shape (K, V, 3).
    """
    return np.asarray(np.tensordot(np.linalg.pinv(weights, rcond=1e-6), changes, 1))


def _largest_errors(moved: Floats64, curves: Floats64, shapes: Floats64) -> Floats64:
    """Return the largest error of the sum of shapes at each vertex, shape (V,)."""
    off = (curves @ shapes).reshape(moved.shape) - moved
    squares = np.einsum("nvc,nvc->nv", off, off)
    return np.asarray(np.sqrt(squares.max(axis=0)))


def _targets_with_weights(moved: Floats64, curves: Floats64, shapes: Floats64) -> Morphs:
    """Turn the product of curves (N, k) and shapes (k, 3 V) into targets with weights 0..1."""
    signs = np.where(curves.max(axis=0) >= -curves.min(axis=0), 1.0, -1.0)
    curves = curves * signs
    shapes = shapes * signs[:, None]
    lowest = np.minimum(curves.min(axis=0), 0.0)
    lengths = curves.max(axis=0) - lowest
    targets = np.vstack([lowest @ shapes, lengths[:, None] * shapes])
    shifted = (curves - lowest) / np.where(lengths > 0.0, lengths, 1.0)
    unit_weights = np.clip(shifted, 0.0, 1.0)
    weights = np.column_stack([np.ones(len(moved)), unit_weights])
    kept = np.abs(targets).max(axis=1, initial=0.0) > LEAST_TARGET_MOTION
    targets = targets[kept]
    weights = weights[:, kept]
    error = float(_largest_errors(moved, weights, targets).max())
    return Morphs(targets.reshape(-1, *moved.shape[1:]), weights, error)
