"""Orders in which the same triangles may be drawn: as they come, for a vertex cache, as strips.

Kähler, Haber, Seidel 2003, section 6, wish for triangle strips. A graphics processor keeps the last
few transformed vertices; what an order is worth shows in how many it transforms per triangle:

    acmr      misses per triangle of a first-in first-out cache (average cache miss ratio):
              3 at random, 0.5 at best in a large mesh
    tipsify   Sander, Nehab, Barczak 2007, "Fast triangle reordering for vertex locality and reduced
              overdraw": fan around vertices that are still in the cache; linear in time
    strips    from each triangle that is left, the longest of its three strips, in turn left and
              right; strips are joined by the index that restarts a primitive
"""

from __future__ import annotations

import numba
import numpy as np
import numpy.typing as npt

Unsigned = npt.NDArray[np.uint32]
Indices = npt.NDArray[np.int32]

RESTART = np.uint32(0xFFFFFFFF)
"""Index that ends a strip, fixed by moderngl for 32 bit indices."""
CACHE_SIZE = 16
"""Entries that `tipsify` counts on."""
NONE = np.int32(-1)


@numba.njit(cache=True)
def acmr(indices: Unsigned, vertex_count: int, triangle_count: int, entries: int) -> float:
    """Misses per triangle of a first-in first-out cache with so many entries."""
    fetched = np.full(vertex_count, -entries - 1, np.int64)
    misses = 0
    for index in indices:
        if index != RESTART and misses - fetched[index] > entries:
            fetched[index] = misses
            misses += 1
    return misses / max(triangle_count, 1)


@numba.njit(cache=True)
def tipsify(triangles: Unsigned, vertex_count: int, entries: int) -> Unsigned:
    """Return the triangles, shape (M, 3), in an order for a vertex cache with so many entries."""
    starts = np.zeros(vertex_count + 1, np.int64)
    for t in range(triangles.shape[0]):
        for i in range(3):
            starts[triangles[t, i] + 1] += 1
    for v in range(vertex_count):
        starts[v + 1] += starts[v]
    left = np.zeros(vertex_count, np.int32)  # triangles around a vertex that are not drawn yet
    around = np.empty(3 * triangles.shape[0], np.int32)
    for t in range(triangles.shape[0]):
        for i in range(3):
            v = triangles[t, i]
            around[starts[v] + left[v]] = t
            left[v] += 1
    ordered = np.empty_like(triangles)
    is_drawn = np.zeros(triangles.shape[0], np.bool_)
    fetched = np.full(vertex_count, -entries - 1, np.int64)
    passed = np.empty(3 * triangles.shape[0], np.uint32)  # vertices to come back to at dead ends
    passed_count = drawn_count = scanned = 0
    time = np.int64(0)
    centre = np.int64(0) if vertex_count else np.int64(-1)
    while centre >= 0:
        first_candidate = passed_count
        for k in range(starts[centre], starts[centre + 1]):
            t = around[k]
            if is_drawn[t]:
                continue
            is_drawn[t] = True
            for i in range(3):
                v = triangles[t, i]
                ordered[drawn_count, i] = v
                passed[passed_count] = v
                passed_count += 1
                left[v] -= 1
                if time - fetched[v] > entries:
                    fetched[v] = time
                    time += 1
            drawn_count += 1
        centre, oldest = np.int64(-1), np.int64(-1)
        for k in range(first_candidate, passed_count):
            v = passed[k]
            if left[v] > 0:
                # The one that has been in longest, if it stays while its triangles are drawn.
                age = time - fetched[v]
                worth = age if age + 2 * left[v] <= entries else np.int64(0)
                if worth > oldest:
                    centre, oldest = np.int64(v), worth
        while centre < 0 and passed_count > 0:
            passed_count -= 1
            if left[passed[passed_count]] > 0:
                centre = np.int64(passed[passed_count])
        while centre < 0 and scanned < vertex_count:
            if left[scanned] > 0:
                centre = np.int64(scanned)
            scanned += 1
    return ordered


@numba.njit(cache=True)
def opposite_sides(triangles: Unsigned, vertex_count: int) -> Indices:
    """For side i of triangle t, number 3 t + i, the one that runs the other way; -1 for none."""
    heads = np.full(2 * vertex_count, NONE, np.int32)
    following = np.empty(triangles.size, np.int32)
    opposite = np.full(triangles.size, NONE, np.int32)
    for t in range(triangles.shape[0]):
        for i in range(3):
            a, b = triangles[t, i], triangles[t, (i + 1) % 3]
            side = heads[a + b]
            while side >= 0:
                u, j = side // 3, side % 3
                if triangles[u, j] == b and triangles[u, (j + 1) % 3] == a and opposite[side] < 0:
                    break
                side = following[side]
            if side >= 0:
                opposite[side], opposite[3 * t + i] = 3 * t + i, side
            else:
                following[3 * t + i] = heads[a + b]
                heads[a + b] = 3 * t + i
    return opposite


@numba.njit(cache=True)
def strips(triangles: Unsigned, opposite: Indices) -> Unsigned:
    """Return strips that cover all triangles, shape (I,), a RESTART after each but the last."""
    seen = np.zeros(triangles.shape[0], np.int64)  # number of the walk that came by; -1: drawn
    indices = np.empty(4 * triangles.shape[0] + 1, np.uint32)
    count, walk = 0, np.int64(0)
    for first in range(triangles.shape[0]):
        if seen[first] < 0:
            continue
        longest, best = 0, 0
        for turn in range(3):
            walk += 1
            length, side, is_right = 0, 3 * first + turn, False
            while side >= 0 and seen[side // 3] >= 0 and seen[side // 3] != walk:
                seen[side // 3] = walk
                length += 1
                t, j = side // 3, side % 3
                side = opposite[3 * t + (j + (2 if is_right else 1)) % 3]
                is_right = not is_right
            if length > longest:
                longest, best = length, turn
        t, j, is_right = first, best, False
        indices[count], indices[count + 1] = triangles[t, j], triangles[t, (j + 1) % 3]
        count += 2
        for _ in range(longest):
            seen[t] = -1
            indices[count] = triangles[t, (j + 2) % 3]
            count += 1
            side = opposite[3 * t + (j + (2 if is_right else 1)) % 3]
            is_right = not is_right
            t, j = side // 3, side % 3
        indices[count] = RESTART
        count += 1
    return indices[: max(count - 1, 0)].copy()
