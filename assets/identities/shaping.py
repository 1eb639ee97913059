"""Bend the built-in head into one of other measures, as smoothly as can be.

How faces differ is taken for a random field of displacements: smooth, larger over long ways than
over short ones, the same on both sides. Of all fields under which the measures are the wanted ones,
the likeliest is chosen. The field is defined in space, so that eyes and teeth go with the skin.
Sources: Lüthi, Gerig, Jud, Vetter 2018, "Gaussian process morphable models" (a face's shape as a
Gaussian process with such kernels, conditioned on what is known); Blanz, Vetter 1999.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..errors import AssetError
from ..model import Eye, FloatArray, Head
from ..norms import DISTANCES, NORMS

# How far points move together [mm], and how far they move over such ways.
KERNEL = ((75.0, 7.0), (30.0, 3.5), (15.0, 1.6), (8.0, 1.0))
MIRROR = np.array([-1.0, 1.0, 1.0])
STAGES, NEWTON_STEPS = 6, 12  # on the way, so that no step leads astray; then to the end
NEAR = 1e-4  # [mm]
TOLERANCE = 0.05  # [mm]: what is farther off is told
JITTER = 1e-7  # of the largest eigenvalue, so that points that nearly coincide do no harm

# An eye's length is hardly more than en-en and ex-ex make it in front view. What they leave of it,
# up and back, is looked for in its place: Newton's method would divide by almost nothing.
EYE = "en-ex"


@dataclass(frozen=True)
class Field:
    """x -> where it comes to lie: scaled about the origin, then displaced.

    centres: of the kernels, shape (n, 3); weights: of each, shape (n, 3).
    """

    scale: float
    centres: FloatArray
    weights: FloatArray

    def points(self, points: npt.ArrayLike) -> FloatArray:
        """Points moved, shape (m, 3)."""
        x = np.asarray(points, dtype=np.float64)
        moved: FloatArray = self.scale * x + kernel(x, self.centres) @ self.weights
        return moved


def kernel(a: FloatArray, b: FloatArray) -> FloatArray:
    """How alike points (n, 3) and (m, 3) move, shape (n, m)."""
    squares = (a * a).sum(axis=1)[:, None] + (b * b).sum(axis=1) - 2.0 * a @ b.T
    squares = np.maximum(squares, 0.0)
    return np.asarray(sum(far**2 * np.exp(-squares / (2.0 * way**2)) for way, far in KERNEL))


class Shaper:
    """Finds fields for one head, whose points are always the same."""

    def __init__(self, head: Head, more: Sequence[int]) -> None:
        """more: numbers of vertices that are pushed, beside those that are measured."""
        ends = [head.anatomy[name] for pair in DISTANCES.values() for name in pair]
        numbers = np.unique([*ends, *more])
        numbers = np.unique(np.concatenate([numbers, head.mirror[numbers]]))
        self._place = {int(number): i for i, number in enumerate(numbers)}
        self._rest: FloatArray = head.vertices[numbers]
        self._opposite = np.array([self._place[int(head.mirror[n])] for n in numbers])
        self._ends = np.array(
            [[self._place[head.anatomy[name]] for name in DISTANCES[code]] for code in NORMS]
        )
        alike = kernel(self._rest, self._rest)
        self._alike = alike + JITTER * alike.max() * len(alike) * np.eye(len(alike))

    def fit(
        self,
        measures: Mapping[str, float],
        pushes: Mapping[int, FloatArray],
        uneven: Mapping[int, FloatArray],
    ) -> Field:
        """The likeliest field under which distances are these [mm].

        pushes: how much farther than measures alone would have it vertices go [mm], with their
            mirror images. uneven: how far they go while their mirror images go the other way; it
            changes measures by tenths, but for those of one side, whose mean stays.
        Raises AssetError where measures contradict each other.
        """
        sides = (measures["ex-ex"] - measures["en-en"]) / 2.0
        up_and_back = np.sqrt(max(measures[EYE] ** 2 - sides**2, 1.0))
        wanted = np.array([up_and_back if code == EYE else measures[code] for code in NORMS])
        scale = float(np.exp(np.log(wanted / self._lengths(self._rest)[1]).mean()))
        rows = np.zeros((len(pushes), *self._rest.shape))
        for row, (number, way) in zip(rows, pushes.items(), strict=True):
            row[self._place[number]] = way / np.linalg.norm(way)
        none = np.zeros_like(self._rest)
        weights = self._solve(scale, wanted, none, rows[:0], np.zeros(0))
        farther = np.array([np.linalg.norm(way) for way in pushes.values()])
        weights = self._solve(scale, wanted, weights, rows, farther)
        off = np.abs(self._lengths(scale * self._rest + self._alike @ weights)[1] - wanted)
        if not off.max() < TOLERANCE:
            code = list(NORMS)[int(np.argmax(off))]
            raise AssetError(f"no head has these measures: {code} of {measures[code]:.1f} mm fails")
        askew = none.copy()
        for number, way in uneven.items():
            place = self._place[number]
            askew[place] += way / self._alike[place, place]
            askew[self._opposite[place]] -= MIRROR * way / self._alike[place, place]
        return Field(scale, self._rest, weights + askew)

    def _solve(
        self,
        scale: float,
        wanted: FloatArray,
        weights: FloatArray,
        rows: FloatArray,
        farther: FloatArray,
    ) -> FloatArray:
        """Weights of the kernels: Newton's method on the lengths, each step the likeliest field.

        weights: those to begin with. rows (k, n, 3): what else of the field is told; farther (k,):
        by how much that has to change.
        """
        base, field = scale * self._rest, self._alike @ weights
        at_first = self._lengths(base + field)[1]
        values = (rows * field).sum(axis=(1, 2))
        for step in range(STAGES + NEWTON_STEPS):
            share = min((step + 1) / STAGES, 1.0)
            field = self._alike @ weights
            gradients, lengths = self._lengths(base + field)
            if step > STAGES and np.abs(wanted - lengths).max() < NEAR:
                break
            left = at_first + share * (wanted - at_first) - lengths
            right = [left + (gradients * field).sum(axis=(1, 2)), values + share * farther]
            even = self._even(np.concatenate([gradients, rows]))
            system = np.einsum("anc,nm,bmc->ab", even, self._alike, even, optimize=True)
            system += 1e-9 * np.trace(system) * np.eye(len(system))
            weights = np.einsum("k,knc->nc", np.linalg.solve(system, np.concatenate(right)), even)
        return weights

    def _lengths(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How lengths change with the points, shape (k, n, 3), and what they are, shape (k,)."""
        ways = points[self._ends[:, 0]] - points[self._ends[:, 1]]
        ways[list(NORMS).index(EYE), 0] = 0.0
        lengths = np.linalg.norm(ways, axis=1)
        gradients = np.zeros((len(ways), *points.shape))
        for gradient, (a, b), way in zip(
            gradients, self._ends, ways / lengths[:, None], strict=True
        ):
            gradient[a], gradient[b] = way, -way
        return gradients, lengths

    def _even(self, rows: FloatArray) -> FloatArray:
        """The part of vectors (..., n, 3) at the points that is its own mirror image."""
        evened: FloatArray = 0.5 * (rows + rows[..., self._opposite, :] * MIRROR)
        return evened


def measures_of(vertices: FloatArray, anatomy: Mapping[str, int]) -> dict[str, float]:
    """All `DISTANCES` between vertices (V, 3), code -> [mm].

    What is taken on one side is the mean of both.
    """

    def between(first: str, second: str) -> float:
        """Their distance."""
        return float(np.linalg.norm(vertices[anatomy[first]] - vertices[anatomy[second]]))

    right = {name: name.replace("_left", "_right") for pair in DISTANCES.values() for name in pair}
    return {
        code: between(a, b)
        if "_right" in a + b
        else 0.5 * (between(a, b) + between(right[a], right[b]))
        for code, (a, b) in DISTANCES.items()
    }


def lids_on_eyes(
    known: Head, vertices: FloatArray, eyes: Sequence[Eye], shares: Sequence[float]
) -> FloatArray:
    """Vertices moved so that lids lie as far from eyes as the built-in head's.

    eyes: in the order of `known.eyes`. shares: for each row of vertices around the eye, from its
    edge out, how much of the way it goes. The corners of the eye, which rest on flesh, stay.
    """
    placed = vertices.copy()
    for old, new in zip(known.eyes, eyes, strict=True):
        for row, share in enumerate(shares):
            ring = known.rings[f"eye_{row}_{old.name}"]
            ring = np.delete(ring, [0, len(ring) // 2])
            above = np.linalg.norm(known.vertices[ring] - old.centre, axis=1) / old.radius
            away = vertices[ring] - new.centre
            nearer = new.radius * above / np.linalg.norm(away, axis=1) - 1.0
            placed[ring] += share * nearer[:, None] * away
    return placed
