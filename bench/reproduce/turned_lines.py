"""Lines inside triangles that turn from one frame to the next: what section 4.4 is against.

Subtriangles of one input triangle meet along lines. A line whose two end points are both still
there, and which is not, has turned: flat shaded, the triangle flickers.
"""

from __future__ import annotations

from collections import Counter

from risorius import refine

Point = tuple[int, int, int]
"""A point of a refined mesh for life: ends of its edge, and quarters from the lower one."""
Line = tuple[int, Point, Point]
"""Input triangle and end points."""


def point_rows(refiner: refine.Refiner) -> dict[Point, int]:
    """A row of the last frame for each of its points on edges and corners."""
    origins = refiner.origins()
    rows: dict[Point, int] = {}
    for row, (vertices, weights) in enumerate(zip(origins.vertices, origins.weights, strict=True)):
        parts = sorted(
            (int(v), round(4.0 * float(w))) for v, w in zip(vertices, weights, strict=True) if w
        )
        first, last = parts[0][0], parts[-1][0]
        if len(parts) == 3:  # a point in the middle of a triangle: blending makes them
            rows[first, parts[1][0], -1 - last] = row
        else:
            rows.setdefault((first, last, parts[-1][1] if last != first else 0), row)
    return rows


def inner_lines(refiner: refine.Refiner, mesh: refine.RefinedMesh) -> set[Line]:
    """The lines inside input triangles in the last frame."""
    names = {row: point for point, row in point_rows(refiner).items()}
    sides: Counter[Line] = Counter()
    for source, corners in zip(mesh.source.tolist(), mesh.triangles.tolist(), strict=True):
        for k in range(3):
            a, b = sorted((names[corners[k]], names[corners[(k + 1) % 3]]))
            sides[source, a, b] += 1
    return {line for line, count in sides.items() if count == 2}


def turned(before: set[Line], now: set[Line], rows: dict[Point, int]) -> list[Line]:
    """Lines of the frame before that are gone although `rows` still has both their ends."""
    return sorted(line for line in before - now if line[1] in rows and line[2] in rows)
