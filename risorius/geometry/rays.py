"""Where lines meet triangles.

Source: Möller, Trumbore 1997, "Fast, minimum storage ray/triangle intersection", Journal of
Graphics Tools 2:21-28.
"""

import numpy as np
import numpy.typing as npt

from .arrays import Floats64
from .normals import cross_products

PARALLEL = 1e-12  # below it a triangle is seen from its edge, and nothing is met


def crossings(origins: Floats64, directions: Floats64, corners: Floats64) -> tuple[Floats64, ...]:
    """Of each line `origin + t direction` and its triangle: volume, weights u and v, and t.

    origins, directions: (n, 3) or (3,). corners: (n, 3, 3). volume: six times that of direction
    and triangle, above 0 where the line comes from outside; the rest is 0 where it is PARALLEL.
    The triangle is met where u, v and 1 - u - v are not negative. Four arrays (n,).
    """
    a = corners[:, 0]
    ab = corners[:, 1] - corners[:, 0]
    ac = corners[:, 2] - corners[:, 0]
    across = np.cross(directions, ac)
    from_a = origins - a
    turned = np.cross(from_a, ab)
    volume = (ab * across).sum(axis=1)
    is_met = np.abs(volume) > PARALLEL
    share = np.divide(1.0, volume, out=np.zeros_like(volume), where=is_met)
    u = (from_a * across).sum(axis=1)
    v = (turned * directions).sum(axis=1)
    return volume, u * share, v * share, (ac * turned).sum(axis=1) * share


def exits(
    origin: Floats64, directions: Floats64, vertices: Floats64, faces: npt.NDArray[np.integer]
) -> tuple[npt.NDArray[np.intp], Floats64, Floats64]:
    """Where rays from one point within a surface pass through it from inside to outside.

    directions: unit vectors, shape (n, 3). vertices: shape (V, 3). faces: counter-clockwise seen
    from outside, shape (F, 3). Of each exit the number of its ray, the distance, and the cosine
    between ray and normal; a ray has as many exits as there are layers of surface around it.
    """
    normals = cross_products(vertices, faces)
    corners = vertices[faces] - origin
    is_seen = (normals * corners[:, 0]).sum(axis=1) > 0.0  # its inner side
    normals = normals[is_seen]
    corners = corners[is_seen]
    ways = corners / np.maximum(np.linalg.norm(corners, axis=2, keepdims=True), PARALLEL)
    middle = ways.sum(axis=1)
    middle /= np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), PARALLEL)
    # A triangle lies in the cone around its middle that its corners span, unless that is blunt.
    cone = np.einsum("fik,fk->fi", ways, middle).min(axis=1)
    cone_slack = 1e-6  # of a cosine, for rounding
    cone = np.where(cone > 0.0, cone - cone_slack, -2.0).astype(np.float32)
    cosines = directions.astype(np.float32) @ middle.T.astype(np.float32)
    ray, face = np.nonzero(cosines >= cone)
    _, u, v, distance = crossings(np.zeros(3), directions[ray], corners[face])
    is_met = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 0.0)
    ray = ray[is_met]
    face = face[is_met]
    distance = distance[is_met]
    length = np.linalg.norm(normals[face], axis=1)
    cosine = (directions[ray] * normals[face]).sum(axis=1) / length
    return ray, distance, cosine
