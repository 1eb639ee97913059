"""Checks that every head mesh must pass: one clean, symmetric surface."""

import numpy as np
from numpy.linalg import norm

from risorius.assets.model import Head, Part
from risorius.assets.topology import Edge
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.mesh_graph import pieces_of
from risorius.geometry.normals import cross_products
from risorius.geometry.sides import sides_of


def edge_faces(faces: Integers32) -> dict[Edge, list[int]]:
    """Numbers of the faces at each undirected edge, in the order of the face list."""
    result: dict[Edge, list[int]] = {}
    for index, (a, b, c) in enumerate(faces.tolist()):
        for first, second in ((a, b), (b, c), (c, a)):
            result.setdefault((min(first, second), max(first, second)), []).append(index)
    return result


def is_manifold(faces: Integers32) -> bool:
    """Whether every edge has one face, or two faces that run along it in opposite directions."""
    directed = sides_of(faces)
    has_no_repeat = len(np.unique(directed, axis=0)) == len(directed)
    most_faces = max(map(len, edge_faces(faces).values()))
    return has_no_repeat and most_faces <= 2


def component_count(faces: Integers32) -> int:
    """The number of pieces of a mesh; faces with a common vertex are in one piece."""
    return len(np.unique(pieces_of(faces, int(faces.max()) + 1)[faces]))


def euler_characteristic(vertices: Floats64, faces: Integers32) -> int:
    """Vertices - edges + faces: 2 - boundary loops for a sphere with holes."""
    return len(vertices) - len(edge_faces(faces)) + len(faces)


def mirror_error(vertices: Floats64, mirror: Integers32) -> float:
    """Largest distance between a vertex's mirror image and its partner vertex [mm]."""
    return float(np.abs(vertices * [-1.0, 1.0, 1.0] - vertices[mirror]).max())


def is_mirrored(faces: Integers32, mirror: Integers32) -> bool:
    """Whether the mirror image of every face is a face with reversed corners."""

    def normalised(triangles: Integers32) -> set[tuple[int, ...]]:
        """The triangles, each rotated so that its lowest vertex comes first."""
        start = triangles.argmin(axis=1)
        order = (start[:, None] + np.arange(3)) % 3
        return set(map(tuple, np.take_along_axis(triangles, order, axis=1).tolist()))

    return normalised(faces) == normalised(mirror[faces][:, ::-1])


def check_part(part: Part, *, least_agreeing: float = 0.98) -> None:
    """Check that the part's arrays fit together, and that unit normals face the drawn side."""
    assert part.vertices.dtype == part.normals.dtype == part.colours.dtype == np.float32
    assert part.faces.dtype == np.int32
    rows = np.hstack([part.vertices, part.normals, part.colours])
    assert rows.shape == (len(part.vertices), 9)
    assert np.isfinite(rows).all()
    assert part.faces.min() >= 0
    assert part.faces.max() < len(rows)
    assert part.colours.min() >= 0.0
    assert part.colours.max() <= 1.0
    assert np.allclose(norm(part.normals, axis=1), 1.0, atol=1e-4)
    facing = cross_products(part.vertices.astype(np.float64), part.faces)
    agreeing = (facing * part.normals[part.faces].sum(axis=1)).sum(axis=1)
    assert (agreeing > 0.0).mean() > least_agreeing, part.name


def part_of(head: Head, name: str) -> Part:
    """The part with this name."""
    return next(found for found in head.parts if found.name == name)


def winding_numbers(vertices: Floats64, faces: Integers32, points: Floats64) -> Floats64:
    """Winding numbers of a surface around points, shape (n,): 1 deep inside, 0 outside.

    Near openings a number lies between 0 and 1. Source: Jacobson et al. 2013, "Robust
    inside-outside segmentation using generalized winding numbers", equation 5 (van Oosterom,
    Strackee 1983).
    """
    corners = vertices[faces] - points[:, None, None].astype(float)
    a, b, c = np.moveaxis(corners, 2, 0)
    length_a, length_b, length_c = (norm(each, axis=2) for each in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=2)
    share = length_a * length_b * length_c
    share += (a * b).sum(axis=2) * length_c + (b * c).sum(axis=2) * length_a
    share += (c * a).sum(axis=2) * length_b
    return np.asarray(np.arctan2(volume, share).sum(axis=1) / (2.0 * np.pi))
