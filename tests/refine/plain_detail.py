"""The scheme `detail` again, in plain Python: detail at rest moves with the surface.

The difference of the finer mesh is read from the refiner itself, at rest and with all edges split
twice, by the names of its points; its motion is computed here. Another test compares the difference
with the finer mesh (test_detail.py).
"""

from tests.refine.plain_schemes import CurveRules, Face, cross, cubic, dot
from tests.refine.plain_twin import EdgeName, Name, Vector, mix, unit

Axes = tuple[Vector, Vector, Vector]
Seen = dict[Name, Vector]
"""Position of every point."""


def axes_of(form: CurveRules, edge: EdgeName, quarters: int) -> Axes:
    """Three directions at a point of an edge: up, nearly along the edge, and across.

    Up is the mean normal, made perpendicular to the edge; at quarter points it is half way to the
    normal of the nearer end.
    """
    a, b = edge
    along = mix((1, form.positions[b]), (-1, form.positions[a]))
    mean = mix((1, form.normals[a]), (1, form.normals[b]))
    up = unit(mix((1, mean), (-dot(mean, along) / dot(along, along), along)))
    if quarters != 2:
        up = unit(mix((1, up), (1, form.normals[a if quarters == 1 else b])))
    along = unit(mix((1, along), (-dot(along, up), up)))
    return up, along, cross(up, along)


def detail_rules(
    rest: list[Vector], positions: list[Vector], faces: list[Face], seen: Seen
) -> CurveRules:
    """Cubic edges plus offsets, turned from axes at rest to present axes.

    The offsets are missing in the cubic edges at rest.
    """
    before = cubic(rest, rest, faces)
    now = cubic(rest, positions, faces)

    def curve(edge: EdgeName, quarters: int) -> Vector:
        missing = mix((1, seen["edge", *edge, quarters]), (-1, before.curve(edge, quarters)))
        axes = (axes_of(form, edge, quarters) for form in (before, now))
        shares = ((dot(missing, then), axis) for then, axis in zip(*axes, strict=True))
        return mix((1, now.curve(edge, quarters)), *shares)

    return CurveRules(positions, faces, curve, now.normals)
