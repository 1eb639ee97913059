"""Dress persons: shirts, masks and glasses.

Lenses are clear, so only the frame of glasses is drawn. The frame moves with the head, and does not
touch the resting skin. All sizes are chosen by eye, after usual frames (lens 48 mm, bridge 18 mm,
temple 140 mm).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats64, Integers32
from ..loading import load
from ..model import GLASSES_NAME, Part
from ..topology import quarter
from .beards import BEARD_NAME, pressed_flat
from .hair import HAIR_CUTS, HAIR_NAME, Fall
from .hair_over_collar import over_collar
from .mask import MASK_COLOURS, mask
from .person import Person
from .shirts import in_shirt
from .wires import Colour, beside_head, joined, tube


@dataclass(frozen=True)
class GlassesFrame:
    """A frame of glasses.

    - half_width, half_height: half the width and half the height of a lens [mm].
    - squareness: exponent of a lens' superellipse; 2 is an ellipse, more approaches a rectangle.
    - thickness: diameter of the rims [mm].
    - colour: sRGB.
    - shine: specular strength, 0 (dull) to 1 (wet). Keep it low: where rims are one or two pixels
      wide, strong highlights break into dashes.
    """

    half_width: float
    half_height: float
    squareness: float
    thickness: float
    colour: Colour
    shine: float


GLASSES_FRAMES: Mapping[str, GlassesFrame] = MappingProxyType(
    {
        "round": GlassesFrame(23.5, 21.5, 2.2, 1.6, (0.33, 0.28, 0.22), 0.15),
        "rectangular": GlassesFrame(26.0, 17.5, 3.6, 2.6, (0.045, 0.045, 0.05), 0.08),
        "oval": GlassesFrame(25.0, 19.0, 2.6, 2.2, (0.24, 0.12, 0.06), 0.1),
    }
)


def wearing(
    person: Person,
    *,
    shirt: str,
    collar: str = "band",
    frame: str | None = None,
    cover: str | None = None,
) -> Person:
    """Dress a person in a shirt of SHIRT_COLOURS with a collar of COLLAR_BUILDERS.

    frame: glasses of GLASSES_FRAMES, or None. cover: a mask of MASK_COLOURS, or None. Other names
    raise KeyError.
    """
    skin = person.vertices[person.faces]
    parts = [
        in_shirt(part, skin, shirt, collar) if part.bone == "neck" else part
        for part in person.parts
    ]
    if isinstance(HAIR_CUTS[person.identity.cut], Fall):
        worn = next(part for part in parts if part.bone == "neck")
        hair = [part for part in parts if part.name.startswith(HAIR_NAME)]
        others = [part for part in parts if not part.name.startswith(HAIR_NAME)]
        parts = [*others, *(over_collar(hair, worn) if hair else ())]
    nose = None
    if cover is not None:
        sheet = mask(person, MASK_COLOURS[cover])
        parts = [
            pressed_flat(part, sheet.vertices) if part.name == BEARD_NAME else part
            for part in parts
        ]
        parts.append(sheet)
        nose = sheet.vertices.astype(np.float64)
    if frame is not None:
        parts.append(glasses(person, GLASSES_FRAMES[frame], nose))
    return replace(person, parts=tuple(parts))


def glasses(person: Person, frame: GlassesFrame, nose: Floats64 | None = None) -> Part:
    """Make glasses that fit a person; beside a wide nose, the lenses are smaller.

    nose: points of more on which the glasses rest, such as a mask [mm], (n, 3); None: only skin.
    """
    skin = person.vertices
    farthest = 12.0 if nose is None else 20.0  # [mm] that the glasses may move forward
    far = farthest - 6.0  # [mm]; smaller lenses are tried before the glasses move farther
    rests = _points_on(skin)
    rests = rests[rests[:, 2] > person.eyes[0].centre[2]]
    if nose is not None:
        rests = np.vstack([rests, nose])
    tree = scipy.spatial.cKDTree(rests[:, :2])
    for size in (1.0, 0.94, 0.88, 0.82, 0.76):
        front = _front_of(person, frame, size)
        clearance = 0.5 * frame.thickness + 1.0  # [mm] between the frame and the skin
        depths = [clearance + _depth_at(rests, tree, path) for path in front]
        lacking = max(depths)
        if lacking <= max(far, depths[-1] + 1.0):  # where the bridge rests, size does not matter
            break
    forward = np.array([0.0, 0.0, float(np.clip(lacking, -2.0, farthest))])
    rim = front.left + forward
    tubes = [tube(each + forward, frame.thickness, closed=True) for each in front[:2]]
    tubes.append(tube(front.bridge + forward, frame.thickness, closed=False))
    hinge = rim[np.argmax(rim[:, 0] + 0.4 * rim[:, 1])]  # outside, and high
    for side, name in ((1.0, "left"), (-1.0, "right")):
        ear = skin[person.anatomy[f"tragion_{name}"]]
        temple = _temple_path(skin, hinge * [side, 1.0, 1.0], ear, frame.thickness)
        tubes.append(tube(temple, 0.9 * frame.thickness, closed=False))
    surface = joined(tubes)
    return Part(
        name=GLASSES_NAME,
        vertices=surface.points.astype(np.float32),
        normals=surface.normals.astype(np.float32),
        faces=surface.faces,
        colours=np.tile(np.array(frame.colour, np.float32), (len(surface.points), 1)),
        bone="cranium",
        shine=frame.shine,
    )


class _Front(NamedTuple):
    """Paths of a frame without temples [mm], (n, 3): both rims, which are closed, and a bridge."""

    left: Floats64
    right: Floats64
    bridge: Floats64


def _front_of(person: Person, frame: GlassesFrame, size: float) -> _Front:
    """Lay rims and bridge 11 mm before the eyes; lenses have `size` times the frame's size."""
    eyes = {eye.name: eye for eye in person.eyes}
    centre = 0.5 * (eyes["left"].centre + eyes["right"].centre)
    apart = 0.5 * (eyes["left"].centre[0] - eyes["right"].centre[0])
    half_width = size * frame.half_width
    outward = 0.5 * (frame.half_width - half_width)  # wider bridges belong to smaller lenses
    lens = np.array([1.1 * apart + outward, centre[1] - 3.0])
    # The left lens is computed; the right lens is its mirror image.
    cornea = centre[2] + eyes["left"].radius
    around = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    directions = np.stack([np.cos(around), np.sin(around)], axis=-1)
    power = frame.squareness
    reach = (np.abs(directions / [half_width, size * frame.half_height]) ** power).sum(axis=1)
    rim = lens + directions / reach[:, None] ** (1.0 / power)
    inner = lens[0] - half_width
    across = np.linspace(-inner, inner, 13)
    bow = 1.0 - (across / inner) ** 2
    bridge = np.stack([across, lens[1] + 5.0 + 3.0 * bow], axis=-1)
    front = _Front(*(_in_front(each, lens, cornea) for each in (rim, rim * [-1.0, 1.0], bridge)))
    front.bridge[:, 2] += 2.0 * bow
    return front


def _points_on(skin: Floats64) -> Floats64:
    """Return points on the triangles of a face, 2 mm apart on the nose [mm], (n, 3)."""
    for edges in _halved_edges():
        skin = np.vstack([skin, skin[edges].mean(axis=1)])
    return skin


@lru_cache(maxsize=1)
def _halved_edges() -> tuple[Integers32, Integers32]:
    """Return the edges of the built-in head, and those of its quartered triangles, (E, 2)."""
    head = load("head")
    first = quarter(head.faces, len(head.vertices))
    second = quarter(first.faces, len(head.vertices) + len(first.edges))
    return first.edges, second.edges


def _in_front(points: Floats64, lens: Floats64, cornea: float) -> Floats64:
    """Lift points (x, y) of a frame, (n, 2), to its surface, which is curved and tilted, (n, 3).

    lens: centre of the left lens (x, y). cornea: z of the corneas. All lengths are in [mm].
    """
    vertex_distance = 11.0  # [mm] between cornea and lens
    bend = 0.0016 * np.maximum(np.abs(points[:, 0]) - 12.0, 0.0) ** 2
    lean = 0.09 * (points[:, 1] - lens[1])
    return np.column_stack([points, cornea + vertex_distance - bend + lean])


def _depth_at(skin: Floats64, tree: scipy.spatial.cKDTree, points: Floats64) -> float:
    """Return how far skin lies in front of points at most, along z [mm]; negative: behind.

    skin: (V, 3). tree: of its x and y. points: (n, 3).
    """
    beside = 3.0  # [mm] in x and y around a point, within which skin counts
    near = tree.query_ball_point(points[:, :2], beside)
    depths = []
    for found, point in zip(near, points, strict=True):
        if found:
            depths.append(float(skin[found, 2].max() - point[2]))
    return max(depths, default=0.0)


def _temple_path(skin: Floats64, hinge: Floats64, ear: Floats64, thickness: float) -> Floats64:
    """Lay a temple from the hinge over the ear and down behind it: a path [mm], (n, 3)."""
    side = np.sign(hinge[0])
    top = ear + np.array([side * 2.5, 21.0, -4.0])
    straight = beside_head(skin, hinge, top, 0.5 * thickness)
    turn = np.linspace(0.0, 1.0, 9)[1:, None]
    backward = turn * [0.0, 0.0, -16.0]
    down = turn**2 * [-side * 2.0, -17.0, 0.0]
    return np.vstack([straight, straight[-1] + backward + down])
