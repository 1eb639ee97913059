"""Teeth and gums: two arches of individually readable teeth, on the cranium and on the mandible.

Sizes of the crowns are rounded common textbook means of permanent teeth (Wheeler). Every tooth is
a stack of rounded rectangles from the gum to the edge. The gums are a strip along the arch: from
the pocket between cheek and jaw over the ridge that holds the teeth to the tongue's side.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .ambient import in_mouth_light
from .fields import Points, Values, smooth_step, unit
from .solids import Solid, grid_faces, joined, mix

AROUND = 12
LEVELS = (0.0, 0.4, 0.75, 0.93, 1.0)  # rings of a crown, from the gum to the edge
STATIONS = 81  # of the gums along the arch; chosen: almost six to a tooth
EDGE_COLOUR, NECK_COLOUR = (0.955, 0.94, 0.90), (0.94, 0.885, 0.80)
FISSURE_COLOUR = (0.84, 0.76, 0.64)
GUM_COLOUR, MUCOSA_COLOUR, POCKET_COLOUR = (
    (0.83, 0.53, 0.51),
    (0.72, 0.34, 0.33),
    (0.45, 0.16, 0.15),
)
CANINE_COLOUR = (0.99, 0.97, 0.935)  # its dentine is thicker: times that of the others
TIP, FLAT, SQUARE, ROUND, BROAD = "tip", "flat", "square", "round", "broad"
BETWEEN_REDDENING = (0.75, 1.1, 1.25)  # powers: what is left comes from gum
# How far the edge rises toward the gum at its corners [mm], near to the midline and far from it;
# the power of x with which it does so; and how wide the edge is, as a share of the crown.
EDGES = {
    FLAT: (0.3, 0.9, 3.2, 0.93), SQUARE: (0.1, 0.3, 3.2, 0.98), ROUND: (0.55, 1.35, 2.6, 0.93),
    TIP: (1.0, 1.6, 1.5, 0.93), BROAD: (0.4, 0.5, 2.4, 0.86),
}  # fmt: skip
PIT = 0.4  # [mm] that the middle of a broad crown lies below its edge's lowest point
COVERED, PAPILLA = 0.9, 1.5  # [mm] of the crown that gum hides, and of it more between teeth

# Section of the gums: distance outward from the labial line [mm] (or inward from the lingual one),
# distance from the margin toward the root [mm], share of mucosa in the colour, share of the pocket.
OUTER_SECTION = (
    (5.0, 6.5, 1.0, 0.6), (4.0, 9.6, 1.0, 1.0), (1.9, 8.6, 1.0, 0.5), (1.5, 4.2, 0.3, 0.0),
    (1.0, 1.0, 0.0, 0.0), (0.1, 0.0, 0.0, 0.0),
)  # fmt: skip
INNER_SECTION = (
    (-0.2, 0.0, 0.0, 0.0), (0.9, 1.2, 0.0, 0.0), (1.8, 5.0, 0.5, 0.2), (2.4, 11.0, 1.0, 0.8),
)  # fmt: skip
PAD_LENGTH, PAD_DEPTH = 5.0, 8.0  # [mm] the ridge slopes away behind the last molar


@dataclass(frozen=True)
class Tooth:
    """Crown size [mm]: width along the arch, height, depth at the gum and at the edge.

    rise: how far its edge stays behind the arch's, toward the gum [mm].
    lean: sideways of the root for each millimetre of height, away from the midline.
    """

    width: float
    height: float
    neck_depth: float
    edge_depth: float
    rise: float
    lean: float
    shape: str = FLAT


UPPER = (
    Tooth(8.5, 10.6, 6.6, 1.5, 0.0, 0.03), Tooth(6.5, 9.0, 6.0, 1.4, 0.9, 0.08, ROUND),
    Tooth(7.6, 10.4, 7.6, 2.0, 0.0, 0.10, TIP), Tooth(7.0, 8.6, 8.6, 6.0, 0.4, 0.05, BROAD),
    Tooth(6.8, 7.9, 8.6, 6.4, 0.7, 0.02, BROAD), Tooth(10.0, 6.6, 10.0, 8.2, 0.9, 0.0, BROAD),
    Tooth(9.4, 6.2, 10.0, 8.2, 1.1, 0.0, BROAD),
)  # fmt: skip
LOWER = (
    Tooth(5.2, 9.4, 5.6, 1.3, 0.1, 0.0, SQUARE), Tooth(5.7, 9.5, 5.8, 1.3, 0.0, 0.02, SQUARE),
    Tooth(6.8, 10.2, 7.2, 2.8, 0.1, 0.05, TIP), Tooth(7.0, 8.4, 7.4, 3.8, 0.2, 0.04, BROAD),
    Tooth(7.1, 7.6, 8.0, 5.6, 0.5, 0.0, BROAD), Tooth(11.0, 6.0, 9.6, 8.0, 0.7, 0.0, BROAD),
    Tooth(10.4, 5.4, 9.6, 8.0, 0.8, 0.0, BROAD),
)  # fmt: skip


@dataclass(frozen=True)
class Arch:
    """Where a row of teeth stands.

    front: z of the foremost labial surface [mm]; half_width, length: of the arch [mm].
    edge, back_edge: height y of the biting edges in front and at the last molar [mm].
    up: +1 if the roots are above, -1 if below.
    between: share of the light that is lost where neighbours touch; more toward the gum than at the
        edge. The lower row is seen aslant: with much of it, a small picture shows splinters.
    """

    teeth: tuple[Tooth, ...]
    front: float
    half_width: float
    length: float
    edge: float
    back_edge: float
    up: float
    between: float

    def point(self, x: Values) -> Points:
        """The labial line of the arch over x, at the height of the edges, shape (n, 3)."""
        relative = np.minimum(np.abs(x) / self.half_width, 1.0)
        inward = 1.0 - np.sqrt(1.0 - 0.985 * relative**2.2)
        height = self.edge + (self.back_edge - self.edge) * inward
        return np.column_stack([x, height, self.front - self.length * inward])


UPPER_ARCH = Arch(
    UPPER, front=92.6, half_width=28.6, length=46.0, edge=-69.4, back_edge=-69.6, up=1.0,
    between=0.42,
)  # fmt: skip
LOWER_ARCH = Arch(
    LOWER, front=89.6, half_width=26.8, length=44.0, edge=-68.1, back_edge=-70.6, up=-1.0,
    between=0.15,
)  # fmt: skip


def _along(arch: Arch) -> tuple[Values, Points]:
    """Arc length and points of the left half of an arch, densely sampled."""
    x = arch.half_width * np.sin(np.linspace(0.0, np.pi / 2, 400))
    line = arch.point(x)
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    return np.r_[0.0, np.cumsum(steps)], line


def _crown(tooth: Tooth, between: float) -> tuple[Points, npt.NDArray[np.float64]]:
    """Vertices of one crown: x along the arch, y from the edge (0) to the gum, z outward."""
    angle = 2.0 * np.pi * (np.arange(AROUND) + 0.5) / AROUND
    cosine, sine = np.cos(angle), np.sin(angle)
    near, far, power, edge = EDGES[tooth.shape]
    rows, shades = [], []
    for level in LEVELS:
        width = tooth.width * (0.76 + 0.22 * np.sin(np.pi * (0.12 + 0.62 * level)))
        depth = tooth.neck_depth + (tooth.edge_depth - tooth.neck_depth) * level**0.8
        closing = edge if level == 1.0 else 1.0
        x = np.sign(cosine) * np.abs(cosine) ** 0.62 * width * 0.5 * closing
        z = (np.sign(sine) * np.abs(sine) ** 0.75 * closing - 1.0) * depth * 0.5
        z -= 0.5 * level**2  # the labial face curves in toward the edge
        corner = np.where(x < 0.0, near, far) * (2.0 * np.abs(x) / tooth.width) ** power
        y = (1.0 - level) * tooth.height + corner * level**3
        rows.append(np.column_stack([x + tooth.lean * y, y + tooth.rise, z]))
        side = between * (1.0 - 0.45 * level) * smooth_step(0.70, 1.0, np.abs(cosine))
        tint = mix(NECK_COLOUR, EDGE_COLOUR, np.full(AROUND, level**0.6))
        tint = tint * (CANINE_COLOUR if tooth.shape == TIP else 1.0)
        shades.append(tint * (1.0 - side)[:, None] ** np.array(BETWEEN_REDDENING))
    end = rows[-1].mean(axis=0)
    end[1] = rows[-1][:, 1].min() + (PIT if tooth.shape == BROAD else 0.0)
    pit = FISSURE_COLOUR if tooth.shape == BROAD else EDGE_COLOUR
    return np.vstack([*rows, end]), np.vstack([*shades, pit])


def _crown_faces() -> npt.NDArray[np.int32]:
    faces = grid_faces(len(LEVELS), AROUND, wrapped=True)
    last, end = (len(LEVELS) - 1) * AROUND, len(LEVELS) * AROUND
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
        tangent = unit(((ahead - centre) * [1.0, 0.0, 1.0])[None])[0]
        outward = np.array([-tangent[2], 0.0, tangent[0]])
        local, colours = _crown(tooth, arch.between)
        vertices = (
            centre
            + local[:, :1] * tangent
            + local[:, 1:2] * [0.0, arch.up, 0.0]
            + local[:, 2:] * outward
        )
        faces = _crown_faces() if arch.up > 0 else _crown_faces()[:, ::-1]
        solid = Solid(vertices, faces, in_mouth_light(vertices, colours))
        solids += [solid, solid.mirrored()]
    return joined(solids)


def _gum_section(arch: Arch, from_middle: Values) -> tuple[Values, Values, Points]:
    """Distance outward and rise [mm], shape (stations, k), and the colours of a section."""
    ends = np.r_[0.0, np.cumsum([tooth.width for tooth in arch.teeth])]
    middles = 0.5 * (ends[1:] + ends[:-1])
    heights = np.interp(from_middle, middles, [tooth.height + tooth.rise for tooth in arch.teeth])
    depths = np.interp(from_middle, middles, [tooth.neck_depth for tooth in arch.teeth])
    phase = np.interp(from_middle, ends, np.arange(len(ends)))
    between = np.cos(2.0 * np.pi * phase) * 0.5 + 0.5  # 1 where two teeth meet
    behind = smooth_step(-1.0, PAD_LENGTH, from_middle - ends[-1])
    margin = heights - COVERED - PAPILLA * between**1.5 + PAD_DEPTH * behind
    outer, inner = np.array(OUTER_SECTION), np.array(INNER_SECTION)
    narrowed = depths * (1.0 - 0.6 * behind)
    outward = np.hstack(
        [
            np.tile(outer[:, 0], (len(margin), 1)) - 0.8 * behind[:, None],
            -narrowed[:, None] - inner[None, :, 0],
        ]
    )
    both = np.vstack([outer, inner])
    rise = np.minimum(margin[:, None] + both[None, :, 1], 21.0)
    colours = mix(mix(GUM_COLOUR, MUCOSA_COLOUR, both[:, 2]), POCKET_COLOUR, both[:, 3])
    return outward, rise, colours


def gums(arch: Arch) -> Solid:
    """Return the ridge that holds the teeth of an arch, scalloped, with the pocket beside it."""
    length, line = _along(arch)
    width = sum(tooth.width for tooth in arch.teeth)
    last = min(width + PAD_LENGTH, float(length[-1]))
    stations = np.linspace(-last, last, STATIONS)
    from_middle = np.abs(stations)
    centre = np.column_stack([np.interp(from_middle, length, line[:, k]) for k in range(3)])
    centre[:, 0] *= np.sign(stations)
    tangent = unit(np.gradient(centre, axis=0) * [1.0, 0.0, 1.0])
    sideways = np.column_stack([-tangent[:, 2], np.zeros(len(centre)), tangent[:, 0]])
    outward, rise, section_colours = _gum_section(arch, from_middle)
    vertices = (
        centre[:, None, :]
        + outward[:, :, None] * sideways[:, None, :]
        + rise[:, :, None] * np.array([0.0, arch.up, 0.0])
    ).reshape(-1, 3)
    colours = in_mouth_light(vertices, np.tile(section_colours, (len(stations), 1)))
    faces = grid_faces(len(stations), outward.shape[1])
    return Solid(vertices, faces if arch.up > 0 else faces[:, ::-1], colours)
