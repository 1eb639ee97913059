"""Texture coordinates: the skin laid flat as one piece, without seams, mirror image and all.

The left half is flattened, the right one is its mirror image. A Tutte embedding is a valid start:
no triangle is turned over. Then the symmetric Dirichlet energy, which is infinite for a triangle
without area, pulls every triangle toward its own shape and never turns one over; triangles of the
face pull hardest, and what lies behind ears and hairline is given half the length. The back of the
head and the neck hardly pull at all: the skin is closed there, so it must be stretched somewhere.
The holes of eye and mouth are filled while that goes on: so lids and lips cannot slide over each
other, and what is tucked in behind them keeps a little room of its own.

Source: Tutte 1963, "How to draw a graph"; Smith and Schaefer 2015, "Bijective parameterization with
free boundaries" (the energy); descent by L-BFGS that starts from the inverse of the Laplacian,
after Zhu, Bridson and Kaufman 2018, "Blended cured quasi-Newton for distortion optimization".
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from .fields import Points, Values, smooth_step
from .topology import Faces, boundary_loops, edge_faces

Flat = npt.NDArray[np.float64]
Rings = Mapping[str, npt.NDArray[np.integer]]

MARGIN = 0.012  # of the picture stays free on every side: for filtering
BACK_SCALE = 0.40  # chosen: hair, neck and the sides need half the detail of the face
TUCKED_WEIGHT, BACK_WEIGHT, HOLE_WEIGHT = 0.15, 0.15, 0.02  # of the energy; the face has 1
FAR_SHARE = 0.02  # of that weight, on the back of the head and the lower neck
ROUNDS, MEMORY = 1500, 12  # chosen: the energy has settled to 1e-5 by then
ARMIJO, SETTLED = 1e-4, 1e-7


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


def _laplacian(faces: Faces, count: int, weights: Values | None = None) -> sparse.csr_matrix:
    """Graph Laplacian; every edge weighs 1, or the sum of its faces' weights."""
    beside = edge_faces(faces)
    first, second = np.array(list(beside)).T
    strength = np.ones(len(first))
    if weights is not None:
        strength = np.array([weights[pair].sum() for pair in beside.values()])
    matrix = sparse.coo_matrix((strength, (first, second)), shape=(count, count))
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


def _energy(flat: Flat, faces: Faces, inverse: Flat, weights: Values) -> tuple[float, Flat]:
    """Symmetric Dirichlet energy and its gradient; infinite if a triangle is turned over."""
    corner = flat[faces]
    edges = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=2)
    jacobian = edges @ inverse
    determinant = np.linalg.det(jacobian)
    gradient = np.zeros_like(flat)
    if determinant.min() <= 0.0:
        return np.inf, gradient
    squares = (jacobian**2).sum(axis=(1, 2))
    energy = weights @ (squares * (1.0 + determinant**-2))
    cofactor = np.empty_like(jacobian)
    cofactor[:, 0, 0], cofactor[:, 1, 1] = jacobian[:, 1, 1], jacobian[:, 0, 0]
    cofactor[:, 0, 1], cofactor[:, 1, 0] = -jacobian[:, 1, 0], -jacobian[:, 0, 1]
    by_jacobian = 2.0 * (1.0 + determinant**-2)[:, None, None] * jacobian
    by_jacobian -= 2.0 * (squares * determinant**-3)[:, None, None] * cofactor
    by_edges = (weights[:, None, None] * by_jacobian) @ inverse.transpose(0, 2, 1)
    for k in (0, 1):
        np.add.at(gradient, faces[:, k + 1], by_edges[:, :, k])
        np.subtract.at(gradient, faces[:, 0], by_edges[:, :, k])
    return float(energy), gradient


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
    """Descend from a valid layout to one in which the triangles have nearly their own shapes."""
    inverse, weights = _shapes(patch)
    free = np.column_stack([~patch.on_midline, np.ones(len(flat), dtype=bool)])
    solve = _preconditioner(patch, weights, free)
    flat = flat.copy()
    value, gradient = _energy(flat, patch.faces, inverse, weights)
    gradient *= free
    history: list[tuple[Flat, Flat, float]] = []
    for _ in range(ROUNDS):
        step = -_two_loops(gradient, history, solve)
        slope = float((step * gradient).sum())
        if slope >= 0.0:
            history.clear()
            step = -solve(gradient)
            slope = float((step * gradient).sum())
        size = _step_without_flip(flat, step, patch.faces)
        while True:
            trial, trial_gradient = _energy(flat + size * step, patch.faces, inverse, weights)
            if trial <= value + ARMIJO * size * slope or size < 1e-12:
                break
            size *= 0.5
        if size < 1e-12:
            break
        trial_gradient *= free
        change = trial_gradient - gradient
        curvature = float((size * step * change).sum())
        if curvature > 1e-12:
            history = [*history[1 - MEMORY :], (size * step, change, 1.0 / curvature)]
        is_settled = value - trial < SETTLED * value
        flat, value, gradient = flat + size * step, trial, trial_gradient
        if is_settled:
            break
    return flat


def _preconditioner(
    patch: Patch, weights: Values, free: npt.NDArray[np.bool_]
) -> Callable[[Flat], Flat]:
    """A function that solves with the weighted Laplacian of the free coordinates."""
    strength = weights / np.maximum(patch.scales * np.sqrt(weights / patch.weights), 1e-3) ** 2
    matrix = _laplacian(patch.faces, len(patch.rest), strength)
    matrix = matrix + 1e-6 * sparse.diags(matrix.diagonal())
    solvers = [splu(matrix[axis][:, axis].tocsc()).solve for axis in free.T]

    def solve(values: Flat) -> Flat:
        result = np.zeros_like(values)
        for k, solver in enumerate(solvers):
            result[free[:, k], k] = solver(values[free[:, k], k])
        return result

    return solve


def _two_loops(
    gradient: Flat, history: list[tuple[Flat, Flat, float]], solve: Callable[[Flat], Flat]
) -> Flat:
    """The quasi-Newton direction (Nocedal 1980), with `solve` as first guess of the inverse."""
    direction = gradient.copy()
    shares = []
    for step, change, inverse_curvature in reversed(history):
        share = inverse_curvature * float((step * direction).sum())
        shares.append(share)
        direction -= share * change
    direction = solve(direction)
    for (step, change, inverse_curvature), share in zip(history, reversed(shares), strict=True):
        direction += (share - inverse_curvature * float((change * direction).sum())) * step
    return direction


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
