"""Are the 68 landmarks in their order? A group that is not would tear the face.

A group in its order lies more like that group of the built-in head than in any other order. For
points p, template points t and another order q, sum p_i (t_i - t_q(i)) is positive then. A shift of
the whole group leaves it alone, and over its value for p = t it is near 1 for a face, near -1 for
a face in that other order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..errors import AssetError
from ..model import FloatArray, IndexArray
from .mesh_validation import SkinPiece, path_lengths
from .warp import bending

Order = npt.NDArray[np.intp]

DISORDERED = -0.1  # a bit below 0: who has points in order must not be refused
TOLD_APART = 3.0  # [mm] that an order moves points on average, or it cannot be told from positions
SMOOTHER = 0.5  # a warp that bends so much less is that of the landmarks that were meant
MOST_SPREAD = 10.0  # that landmarks reach farther than those before them, unless one is astray
INNER_LIPS = ((61, 62, 63), (65, 66, 67))  # upper, lower
OUTER_LIPS = ((50, 51, 52), (56, 57, 58))


@dataclass(frozen=True)
class Group:
    """Landmarks that follow each other.

    step: how far they may have been shifted; half of a group that has two of something, so that
    these change places.
    """

    name: str
    first: int
    count: int
    right_order: str
    step: int = 1

    def other_orders(self) -> Iterator[Order]:
        """Shifted along, and the other way round."""
        numbers = np.arange(self.first, self.first + self.count)
        for shift in range(0, self.count, self.step):
            if shift:
                yield np.roll(numbers, shift)
            yield np.roll(numbers[::-1], shift)

    @property
    def complaint(self) -> str:
        """What is told of a group that is not in its order."""
        return (
            f"landmarks {self.first} to {self.first + self.count - 1}, the {self.name}, are not in "
            f"their order; right is: {self.right_order} (right and left are the subject's own)"
        )


_OVER = "over the upper lid"
GROUPS = (
    Group("jaw line", 0, 17, "from the subject's right ear over the chin to the left ear"),
    Group("two brows", 17, 10, "the right brow from outside in, then the left from inside out", 5),
    Group("right brow", 17, 5, "from outside in"),
    Group("left brow", 22, 5, "from inside out"),
    Group("bridge of the nose", 27, 4, "downward"),
    Group("base of the nose", 31, 5, "from right to left"),
    Group("two eyes", 36, 12, "first the subject's right eye, then the left", 6),
    Group("right eye", 36, 6, f"from its outer corner {_OVER}"),
    Group("left eye", 42, 6, f"from its inner corner {_OVER}"),
    Group("outer border of the lips", 48, 12, "from the right corner over the upper lip"),
    Group("inner border of the lips", 60, 8, "from the right corner over the upper lip"),
)


def groups_in_disorder(points: FloatArray, template: FloatArray) -> list[Group]:
    """Groups that would fit better in another order; both (68, 3), in the face space [mm].

    What order the inner lips of a closed mouth have only the skin can tell: `check_lips`.
    """
    return [group for group in GROUPS if _is_disordered(group, points, template)]


def _is_disordered(group: Group, points: FloatArray, template: FloatArray) -> bool:
    own = np.arange(group.first, group.first + group.count)
    for other in group.other_orders():
        moved = template[own] - template[other]
        size = 0.5 * float((moved * moved).sum())
        is_told = size > 0.5 * group.count * TOLD_APART**2
        if is_told and float((points[own] * moved).sum()) < DISORDERED * size:
            return True
    return False


def check_lips(skin: SkinPiece) -> None:
    """Raise AssetError where the inner lips' landmarks lie on the other lip's skin each."""
    inner = skin.landmarks[np.ravel(INNER_LIPS)]
    ways = path_lengths(skin.vertices, skin.faces, inner)
    to_upper, to_lower = (ways[:, skin.landmarks[list(lip)]].min(axis=1) for lip in OUTER_LIPS)
    is_upper = to_upper < to_lower
    if not is_upper[:3].any() and is_upper[3:].all():
        raise AssetError(GROUPS[-1].complaint)


def check_counting(vertices: FloatArray, landmarks: IndexArray, template: FloatArray) -> None:
    """Raise AssetError where the vertices before those of the landmarks make more of a face."""
    if landmarks.min() < 1:
        return
    points = [vertices[each] for each in (landmarks, landmarks - 1)]
    largest, smallest = (f(np.ptp(each, axis=0).max() for each in points) for f in (max, min))
    if not 0.0 < largest < MOST_SPREAD * smallest:  # a landmark is far off, and that is the fault
        return
    # Around their middle: far from the origin a warp would bend by rounding alone.
    given, before = (bending(template, (each - each.mean(axis=0)) / largest) for each in points)
    if before < SMOOTHER * given:
        raise AssetError(
            "the landmarks' vertex numbers are counted from 1; count from 0, or subtract 1 from "
            "each"
        )
