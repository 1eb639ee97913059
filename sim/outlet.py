"""From the simulation's frame to the caller's: displacements become positions of the posed head.

One compiled pass, because it runs in every frame and numpy needs eight for it.

Source: own.
"""

from __future__ import annotations

import numpy as np

from ..jit import njit


@njit
def place(x, rest, axes, head_rest, turn, share, out):  # type: ignore[no-untyped-def]
    """Fill `out` (V, 3) [head units]; return how many vertices are not finite and left out.

    x, rest: positions now and at rest [mm]; axes (3, 3): of the standard frame in head coordinates,
    times the scale; head_rest: rest positions [head units]; turn (4, 4): pose of the head;
    share (V, 1): how far each vertex follows it.
    """
    broken = 0
    for i in range(len(x)):
        dx, dy, dz = x[i, 0] - rest[i, 0], x[i, 1] - rest[i, 1], x[i, 2] - rest[i, 2]
        if not np.isfinite(dx + dy + dz):
            broken += 1
            continue
        px = head_rest[i, 0] + dx * axes[0, 0] + dy * axes[1, 0] + dz * axes[2, 0]
        py = head_rest[i, 1] + dx * axes[0, 1] + dy * axes[1, 1] + dz * axes[2, 1]
        pz = head_rest[i, 2] + dx * axes[0, 2] + dy * axes[1, 2] + dz * axes[2, 2]
        s = share[i, 0]
        for k in range(3):
            turned = turn[k, 0] * px + turn[k, 1] * py + turn[k, 2] * pz + turn[k, 3]
            here = px if k == 0 else (py if k == 1 else pz)
            out[i, k] = here + s * (turned - here)
    return broken
