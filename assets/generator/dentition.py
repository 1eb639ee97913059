"""Teeth and gums: two arches of individually readable teeth, on the cranium and on the mandible.

Sizes of the crowns are rounded common textbook means of permanent teeth (Wheeler). Every tooth is
a stack of rounded rectangles from the gum to the edge.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .fields import Points, Values, smooth_step, unit
from .solids import Solid, grid_faces, joined, mix

AROUND, LEVELS = 16, 7
EDGE_COLOUR, NECK_COLOUR = (0.925, 0.895, 0.825), (0.84, 0.755, 0.62)
GUM_COLOUR, GUM_DEEP = (0.74, 0.43, 0.41), (0.45, 0.19, 0.18)
TIP, FLAT = "tip", "flat"


@dataclass(frozen=True)
class Tooth:
    """Crown size [mm]: width along the arch, height, depth at the gum and at the edge, shape."""

    width: float
    height: float
    neck_depth: float
    edge_depth: float
    shape: str = FLAT


UPPER = (
    Tooth(8.5, 10.3, 6.6, 1.5), Tooth(6.6, 9.2, 6.0, 1.4), Tooth(7.6, 10.3, 7.6, 2.0, TIP),
    Tooth(7.0, 8.6, 8.6, 6.0), Tooth(6.8, 8.2, 8.6, 6.4), Tooth(10.0, 7.4, 10.0, 8.2),
    Tooth(9.4, 7.0, 10.0, 8.2),
)  # fmt: skip
LOWER = (
    Tooth(5.2, 8.8, 5.6, 1.3), Tooth(5.7, 9.1, 5.8, 1.3), Tooth(6.8, 10.2, 7.2, 1.9, TIP),
    Tooth(7.0, 8.6, 7.6, 5.4), Tooth(7.1, 8.2, 8.0, 6.2), Tooth(11.0, 7.4, 9.6, 8.0),
    Tooth(10.4, 7.0, 9.6, 8.0),
)  # fmt: skip


@dataclass(frozen=True)
class Arch:
    """Where a row of teeth stands.

    front: z of the foremost labial surface [mm]; half_width, length: of the arch [mm].
    edge: height y of the biting edges [mm]; up: +1 if the roots are above, -1 if below.
    """

    teeth: tuple[Tooth, ...]
    front: float
    half_width: float
    length: float
    edge: float
    up: float

    def point(self, x: Values) -> Points:
        """The labial line of the arch over x, at the height of the edges, shape (n, 3)."""
        relative = np.minimum(np.abs(x) / self.half_width, 1.0)
        z = self.front - self.length * (1.0 - np.sqrt(1.0 - 0.985 * relative**2.2))
        return np.column_stack([x, np.full_like(x, self.edge), z])


UPPER_ARCH = Arch(UPPER, front=92.6, half_width=28.6, length=46.0, edge=-69.2, up=1.0)
LOWER_ARCH = Arch(LOWER, front=89.6, half_width=26.8, length=44.0, edge=-67.4, up=-1.0)


def _along(arch: Arch) -> tuple[Values, Points]:
    """Arc length and points of the left half of an arch, densely sampled."""
    x = arch.half_width * np.sin(np.linspace(0.0, np.pi / 2, 400))
    line = arch.point(x)
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    return np.r_[0.0, np.cumsum(steps)], line


def _crown(tooth: Tooth) -> tuple[Points, npt.NDArray[np.float64]]:
    """Vertices of one crown: x along the arch, y from the edge (0) to the gum, z outward."""
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    rows, shades = [], []
    for level in np.linspace(0.0, 1.0, LEVELS):  # 0 at the gum, 1 at the edge
        width = tooth.width * (0.76 + 0.22 * np.sin(np.pi * (0.12 + 0.62 * level)))
        depth = tooth.neck_depth + (tooth.edge_depth - tooth.neck_depth) * level**0.8
        if tooth.shape == TIP:
            width *= 1.0 - 0.45 * smooth_step(0.6, 1.0, np.array([level]))[0]
        closing = 0.90 if level == 1.0 else 1.0
        cosine, sine = np.cos(angle), np.sin(angle)
        x = np.sign(cosine) * np.abs(cosine) ** 0.62 * width * 0.5 * closing
        z = (np.sign(sine) * np.abs(sine) ** 0.75 - 1.0) * depth * 0.5
        z -= 0.5 * level**2  # the labial face curves in toward the edge
        y = np.full(AROUND, (1.0 - level) * tooth.height)
        y += np.where(np.abs(x) > 0.42 * tooth.width, 0.35 * (level == 1.0), 0.0)
        rows.append(np.column_stack([x, y, z]))
        side = smooth_step(0.70, 1.0, np.abs(cosine))
        tint = mix(NECK_COLOUR, EDGE_COLOUR, np.full(AROUND, level**0.6))
        shades.append(tint * (1.0 - 0.35 * side)[:, None])
    end = rows[-1].mean(axis=0)
    return np.vstack([*rows, end]), np.vstack([*shades, EDGE_COLOUR])


def _crown_faces() -> npt.NDArray[np.int32]:
    faces = grid_faces(LEVELS, AROUND, wrapped=True)
    last, end = (LEVELS - 1) * AROUND, LEVELS * AROUND
    fan = [[last + i, last + (i + 1) % AROUND, end] for i in range(AROUND)]
    return np.vstack([faces, np.array(fan, dtype=np.int32)])


def teeth(arch: Arch) -> Solid:
    """Return all crowns of an arch."""
    length, line = _along(arch)
    solids, start = [], 0.0
    for tooth in arch.teeth:
        middle = start + 0.5 * tooth.width
        start += tooth.width
        centre = np.array([np.interp(middle, length, line[:, k]) for k in range(3)])
        ahead = np.array([np.interp(middle + 0.5, length, line[:, k]) for k in range(3)])
        tangent = (ahead - centre) / np.linalg.norm(ahead - centre)
        outward = np.array([-tangent[2], 0.0, tangent[0]])
        local, colours = _crown(tooth)
        vertices = (
            centre
            + local[:, :1] * tangent
            + local[:, 1:2] * [0.0, arch.up, 0.0]
            + local[:, 2:] * outward
        )
        for side in (1.0, -1.0):
            faces = _crown_faces() if side * arch.up > 0 else _crown_faces()[:, ::-1]
            solids.append(Solid(vertices * [side, 1.0, 1.0], faces, colours))
    return joined(solids)


def gums(arch: Arch) -> Solid:
    """Return the ridge from which the teeth of an arch grow: a tube along it, scalloped."""
    length, line = _along(arch)
    ends = np.r_[0.0, np.cumsum([tooth.width for tooth in arch.teeth])]
    last = min(float(ends[-1]) + 1.0, float(length[-1]))
    stations = np.linspace(-last, last, 89)
    from_middle = np.abs(stations)
    middles = 0.5 * (ends[1:] + ends[:-1])
    heights = np.interp(from_middle, middles, [tooth.height for tooth in arch.teeth])
    phase = np.interp(from_middle, ends, np.arange(len(ends)))
    papilla = 1.3 * (np.cos(2.0 * np.pi * phase) * 0.5 + 0.5)  # gum between teeth reaches further

    centre = np.column_stack([np.interp(from_middle, length, line[:, k]) for k in range(3)])
    centre[:, 0] *= np.sign(stations)
    tangent = unit(np.gradient(centre, axis=0))
    outward = np.column_stack([-tangent[:, 2], np.zeros(len(centre)), tangent[:, 0]])
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    across = 0.9 - 4.6 + 5.2 * np.sign(np.sin(angle)) * np.abs(np.sin(angle)) ** 0.8
    rise = 4.6 * (1.0 + np.sign(np.cos(angle)) * np.abs(np.cos(angle)) ** 0.8)
    edge = (heights - 0.9 - papilla)[:, None] + rise[None, :]
    vertices = (
        centre[:, None, :]
        + across[None, :, None] * outward[:, None, :]
        + edge[:, :, None] * np.array([0.0, arch.up, 0.0])
    ).reshape(-1, 3)
    colours = mix(GUM_COLOUR, GUM_DEEP, np.tile(smooth_step(3.0, 9.0, rise), len(stations)))
    faces = grid_faces(len(stations), AROUND, wrapped=True)
    return Solid(vertices, faces if arch.up > 0 else faces[:, ::-1], colours)
