"""Texture coordinates: the skin laid flat as one piece, without seams, mirror image and all.

The left half is flattened, the right one is its mirror image. A Tutte embedding is a valid start:
no triangle is turned over. Then the symmetric Dirichlet energy, which is infinite for a triangle
without area, pulls every triangle toward its own shape and never turns one over; triangles of the
face pull hardest, and what lies behind ears and hairline is given half the length. The back of the
head and the neck hardly pull at all: the skin is closed there, so it must be stretched somewhere.
The holes of eye and mouth are filled while that goes on: so lids and lips cannot slide over each
other, and what is tucked in behind them keeps a little room of its own.

Source: Tutte 1963, "How to draw a graph"; Smith and Schaefer 2015, "Bijective parameterization with
free boundaries" (the energy); projected Newton descent after Teran, Sifakis, Irving and Fedkiw
2005, "Robust quasistatic finite elements and flesh simulation". It goes on until no force is left:
where it stopped earlier, the processor's rounding would decide where.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from ..errors import AssetError
from ..topology import Faces, boundary_loops, edge_faces
from .fields import Points, Values, smooth_step

Flat = npt.NDArray[np.float64]
Rings = Mapping[str, npt.NDArray[np.integer]]

MARGIN = 0.012  # of the picture stays free on every side: for filtering
BACK_SCALE = 0.40  # chosen: hair, neck and the sides need half the detail of the face
TUCKED_WEIGHT, BACK_WEIGHT, HOLE_WEIGHT = 0.15, 0.15, 0.02  # of the energy; the face has 1
FAR_SHARE = 0.02  # of that weight, on the back of the head and the lower neck
# At that gradient [mm] no vertex is 1e-4 mm off the minimum; measured: reached after 68 rounds.
STEEPEST, ROUNDS = 1e-6, 400
ARMIJO, ROUNDING = 1e-4, 1e-13  # share of the slope, of the energy, that a step must, may change


@dataclass
class Patch:
    """A half of the skin with its holes filled.

    rest: vertices [mm], shape (n, 3); those after `skin_count` fill the holes.
    faces: shape (m, 3).
    scales: wanted length in the picture of a millimetre on each face, shape (m,).
    weights: of each face's energy, shape (m,).
    on_midline: vertices that stay on the mirror line, shape (n,).
    """

    rest: Points
    faces: Faces
    scales: Values
    weights: Values
    on_midline: npt.NDArray[np.bool_]
    skin_count: int


def detail(points: Points) -> Values:
    """Wanted scale of the picture, 1 in the face, less behind and below it, shape (n,)."""
    _, y, z = points.T
    behind = smooth_step(62.0, 22.0, z)
    above = smooth_step(62.0, 92.0, y)
    below = smooth_step(-112.0, -128.0, y)
    return 1.0 - (1.0 - BACK_SCALE) * np.maximum(np.maximum(behind, above), below)


def far(points: Points) -> Values:
    """How far behind the ears or down the neck points lie, 0 to 1, shape (n,)."""
    _, y, z = points.T
    return np.maximum(smooth_step(20.0, -30.0, z), smooth_step(-125.0, -145.0, y))


def _fan(ring: list[int], centre: int, *, closed: bool) -> list[list[int]]:
    ends = [*ring[1:], ring[0]] if closed else ring[1:]
    return [[first, second, centre] for first, second in zip(ring, ends, strict=False)]


def _oriented_like(faces: Faces, fan: list[list[int]]) -> Faces:
    """A fan turned so that it runs along its ring against the faces beside it."""
    directed = {
        tuple(pair) for k in range(3) for pair in np.roll(faces, -k, axis=1)[:, :2].tolist()
    }
    turned = np.array(fan, dtype=np.int32)
    return turned[:, [1, 0, 2]] if (fan[0][0], fan[0][1]) in directed else turned


def fill_holes(vertices: Points, faces: Faces, rings: Rings) -> Patch:
    """The left half as a disc: its eye and its half of the mouth closed by fans of triangles."""
    half = faces[(vertices[faces, 0] >= 0.0).all(axis=1)]
    used = np.unique(half)
    number = np.full(len(vertices), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    half = number[half]
    rest = vertices[used]
    eye, mouth = number[rings["eye_0_left"]].tolist(), number[rings["mouth_0_left"]].tolist()
    middle = rest[[mouth[0], mouth[-1]]].mean(axis=0)
    filled = np.vstack([rest, rest[eye].mean(axis=0), middle])
    fans = np.vstack(
        [
            _oriented_like(half, _fan(eye, len(rest), closed=True)),
            _oriented_like(half, _fan(mouth, len(rest) + 1, closed=False)),
        ]
    )
    tucked = np.concatenate([rings[f"mouth_{row}_left"] for row in (0, 1)] + [rings["eye_0_left"]])
    is_tucked = np.isin(half, number[tucked]).any(axis=1)
    scales = detail(rest[half].mean(axis=1))
    share = (scales - BACK_SCALE) / (1.0 - BACK_SCALE)
    weights = BACK_WEIGHT + (1.0 - BACK_WEIGHT) * share
    weights *= 1.0 - (1.0 - FAR_SHARE) * far(rest[half].mean(axis=1))
    weights[is_tucked] = TUCKED_WEIGHT
    return Patch(
        filled,
        np.vstack([half, fans]),
        np.r_[scales, np.ones(len(fans))],
        np.r_[weights, np.full(len(fans), HOLE_WEIGHT)],
        filled[:, 0] == 0.0,
        len(rest),
    )


def _laplacian(faces: Faces, count: int) -> sparse.csr_matrix:
    """Graph Laplacian in which every edge weighs 1."""
    first, second = np.array(list(edge_faces(faces))).T
    matrix = sparse.coo_matrix((np.ones(len(first)), (first, second)), shape=(count, count))
    matrix = (matrix + matrix.T).tocsr()
    return (sparse.diags(np.asarray(matrix.sum(axis=1)).ravel()) - matrix).tocsr()


def tutte(patch: Patch) -> Flat:
    """Half a disc: mirror line and rim on its border, every other vertex amid its neighbours."""
    loop = np.array(boundary_loops(patch.faces)[0])
    is_middle = patch.on_midline[loop]
    start = int(np.flatnonzero(is_middle & ~np.roll(is_middle, 1))[0])
    loop = np.roll(loop, -start)
    last = int(np.flatnonzero(patch.on_midline[loop])[-1])
    straight, arc = loop[: last + 1], np.r_[loop[last:], loop[0]]
    if patch.rest[straight[0], 1] < patch.rest[straight[-1], 1]:
        straight, arc = straight[::-1], arc[::-1]

    def along(row: npt.NDArray[np.integer]) -> Values:
        """How far along a row each of its vertices lies, 0 to 1."""
        steps = np.linalg.norm(np.diff(patch.rest[row], axis=0), axis=1)
        return np.asarray(np.r_[0.0, np.cumsum(steps)] / steps.sum(), dtype=np.float64)

    radius = 0.5 * np.linalg.norm(np.diff(patch.rest[straight], axis=0), axis=1).sum()
    flat = np.zeros((len(patch.rest), 2))
    turn = np.pi * along(arc)  # the rim runs from the lower end of the mirror line to the upper
    flat[arc] = radius * np.column_stack([np.sin(turn), -np.cos(turn)])
    flat[straight] = np.column_stack([np.zeros(len(straight)), radius * (1 - 2 * along(straight))])
    inner = np.setdiff1d(np.arange(len(flat)), loop)
    matrix = _laplacian(patch.faces, len(flat))
    solve = splu(matrix[inner][:, inner].tocsc()).solve
    flat[inner] = solve(-(matrix[inner][:, loop] @ flat[loop]))
    return flat


def _shapes(patch: Patch) -> tuple[Flat, Values]:
    """Inverse of each triangle's wanted edge matrix, shape (m, 2, 2), and its weighted area."""
    corner = patch.rest[patch.faces]
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    length = np.linalg.norm(first, axis=1)
    along = (first * second).sum(axis=1) / length
    height = np.linalg.norm(np.cross(first, second), axis=1) / length
    edges = np.zeros((len(corner), 2, 2))  # columns: the two edges from the first corner
    edges[:, 0, 0], edges[:, 0, 1], edges[:, 1, 1] = length, along, height
    inverse = np.asarray(np.linalg.inv(edges * patch.scales[:, None, None]), dtype=np.float64)
    return inverse, np.asarray(0.5 * length * height * patch.weights, dtype=np.float64)


def _jacobians(flat: Flat, faces: Faces, inverse: Flat) -> tuple[Flat, Values, Flat]:
    """How each triangle is deformed, its determinant, and that one's derivative; (m, 2, 2), (m,)"""
    corner = flat[faces]
    edges = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=2)
    jacobian = edges @ inverse
    cofactor = np.empty_like(jacobian)
    cofactor[:, 0, 0], cofactor[:, 1, 1] = jacobian[:, 1, 1], jacobian[:, 0, 0]
    cofactor[:, 0, 1], cofactor[:, 1, 0] = -jacobian[:, 1, 0], -jacobian[:, 0, 1]
    return jacobian, np.linalg.det(jacobian), cofactor


def _energy(flat: Flat, faces: Faces, inverse: Flat, weights: Values) -> tuple[float, Flat]:
    """Symmetric Dirichlet energy and its gradient; infinite if a triangle is turned over."""
    jacobian, determinant, cofactor = _jacobians(flat, faces, inverse)
    gradient = np.zeros_like(flat)
    if determinant.min() <= 0.0:
        return np.inf, gradient
    squares = (jacobian**2).sum(axis=(1, 2))
    energy = weights @ (squares * (1.0 + determinant**-2))
    by_jacobian = 2.0 * (1.0 + determinant**-2)[:, None, None] * jacobian
    by_jacobian -= 2.0 * (squares * determinant**-3)[:, None, None] * cofactor
    by_edges = (weights[:, None, None] * by_jacobian) @ inverse.transpose(0, 2, 1)
    for k in (0, 1):
        np.add.at(gradient, faces[:, k + 1], by_edges[:, :, k])
        np.subtract.at(gradient, faces[:, 0], by_edges[:, :, k])
    return float(energy), gradient


def _curvature(flat: Flat, faces: Faces, inverse: Flat, weights: Values) -> sparse.csc_matrix:
    """Second derivatives of the energy, shape (2n, 2n), each triangle's made positive.

    Rows and columns follow `flat.ravel()`; a Newton step with them always leads downhill.
    """
    jacobian, determinant, cofactor = _jacobians(flat, faces, inverse)
    squares = (jacobian**2).sum(axis=(1, 2))
    along, across = jacobian.reshape(-1, 4, 1), cofactor.reshape(-1, 4, 1)
    turned = np.fliplr(np.diag([1.0, -1.0, -1.0, 1.0]))  # derivative of the cofactors
    mixed = along @ across.transpose(0, 2, 1)
    second = 2.0 * (1.0 + determinant**-2)[:, None, None] * np.eye(4)
    second -= 4.0 * (determinant**-3)[:, None, None] * (mixed + mixed.transpose(0, 2, 1))
    second += 6.0 * (squares * determinant**-4)[:, None, None] * across @ across.transpose(0, 2, 1)
    second -= 2.0 * (squares * determinant**-3)[:, None, None] * turned
    values, vectors = np.linalg.eigh(second)
    values = weights[:, None] * np.maximum(values, 0.0)
    second = (vectors * values[:, None, :]) @ vectors.transpose(0, 2, 1)
    # From coordinates of the three corners to the entries of the Jacobian: (m, 2, 2, 3, 2).
    of_corner = np.stack([-inverse.sum(axis=1), inverse[:, 0], inverse[:, 1]], axis=2)
    motion = np.einsum("mck,rs->mrcks", of_corner, np.eye(2)).reshape(-1, 4, 6)
    blocks = motion.transpose(0, 2, 1) @ second @ motion
    place = (2 * faces[:, :, None] + [0, 1]).reshape(-1, 6)
    rows, columns = np.broadcast_arrays(place[:, :, None], place[:, None, :])
    size = flat.size
    return sparse.csc_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))


def _step_without_flip(flat: Flat, step: Flat, faces: Faces) -> float:
    """The largest multiple of `step` (at most 1) that leaves every triangle some area."""
    corner, motion = flat[faces], step[faces]
    e, f = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    p, q = motion[:, 1] - motion[:, 0], motion[:, 2] - motion[:, 0]
    constant = e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    linear = e[:, 0] * q[:, 1] - e[:, 1] * q[:, 0] + p[:, 0] * f[:, 1] - p[:, 1] * f[:, 0]
    square = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    root = np.sqrt(np.maximum(linear**2 - 4.0 * square * constant, 0.0))
    is_real = linear**2 >= 4.0 * square * constant
    # The smallest positive root in the form that divides by nothing small.
    denominator = np.where(is_real, root - linear, 0.0)
    times = np.where(denominator > 1e-30, 2.0 * constant / np.maximum(denominator, 1e-30), np.inf)
    return min(1.0, 0.8 * float(times.min()))


def relax(patch: Patch, flat: Flat) -> Flat:
    """Descend from a valid layout to the one in which triangles are nearest to their own shapes.

    Vertices on the mirror line stay on it, the first of them where it is. Raises AssetError if the
    descent does not arrive.
    """
    inverse, weights = _shapes(patch)
    is_free = np.column_stack([~patch.on_midline, np.ones(len(flat), dtype=bool)])
    is_free[patch.on_midline.argmax(), 1] = False
    free = np.flatnonzero(is_free)
    value, gradient = _energy(flat, patch.faces, inverse, weights)
    for _ in range(ROUNDS):
        force = -gradient.ravel()[free]
        if np.linalg.norm(force) < STEEPEST:
            return flat
        curvature = _curvature(flat, patch.faces, inverse, weights)[free][:, free]
        step = np.zeros_like(flat)
        step.flat[free] = splu(curvature.tocsc()).solve(force)
        slope = -float(step.ravel()[free] @ force)
        size = _step_without_flip(flat, step, patch.faces)
        while True:
            trial, trial_gradient = _energy(flat + size * step, patch.faces, inverse, weights)
            if trial <= value + ARMIJO * size * slope + ROUNDING * value:
                break
            size *= 0.5
        flat, value, gradient = flat + size * step, trial, trial_gradient
    raise AssetError(
        f"the skin could not be laid flat: after {ROUNDS} rounds a force of "
        f"{np.linalg.norm(force):.1e} mm is left; {STEEPEST:.0e} mm is allowed"
    )


def unwrap(
    vertices: Points, faces: Faces, mirror: npt.NDArray[np.int32], rings: Rings
) -> npt.NDArray[np.float32]:
    """Texture coordinates of every vertex, shape (V, 2), float32: u from the subject's right, v up.

    rings: rows of the left side, named as in `Head.rings`.
    """
    patch = fill_holes(vertices, faces, rings)
    flat = relax(patch, tutte(patch))[: patch.skin_count]
    left = vertices[:, 0] >= 0.0
    low, high = flat[:, 1].min(), flat[:, 1].max()
    extent = max(high - low, 2.0 * flat[:, 0].max()) / (1.0 - 2.0 * MARGIN)
    uv = np.zeros((len(vertices), 2))
    uv[left, 0] = 0.5 + flat[:, 0] / extent
    uv[left, 1] = 0.5 + (flat[:, 1] - 0.5 * (low + high)) / extent
    beside = np.flatnonzero(~left)
    uv[beside] = uv[mirror[beside]] * [-1.0, 1.0] + [1.0, 0.0]
    return uv.astype(np.float32)
