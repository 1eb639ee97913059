"""The inside of the mouth: a tongue that bends, and walls that stretch between both jaws.

Colours are darker toward the back of the mouth, where less light arrives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.assets.fitting.mouth_walls import stretched_walls
from risorius.assets.model import MASK_NAME, Part
from risorius.geometry.arrays import Floats32, Floats64
from risorius.geometry.read_only import read_only

from .bent_part import FaceNow, FacePart, HeadPart

# Beginnings of names of parts; the cavity is dark already.
MOUTH_PART_NAMES = ("teeth", "gums", "tongue")


class Gloom(NamedTuple):
    """Loss of colours (sRGB) toward the back of the mouth."""

    begins: float  # [mm] behind the front teeth
    ends: float  # [mm] behind the front teeth
    lost: float  # share of light that is lost from `ends` on
    powers: tuple[float, float, float] = (1.0, 1.0, 1.0)  # exponents for red, green and blue


# Chosen by eye. Light on a molar is reddish, because flesh has reflected it. Little light is lost:
# dark molars would look broken, or missing at the corner of the mouth.
REDDENING_EXPONENTS = (0.9, 1.2, 1.25)
GUM_GLOOM = Gloom(2.0, 34.0, 0.2)
TONGUE_GLOOM = Gloom(-5.0, 53.0, 0.48, (0.92, 1.25, 1.3))
UPPER_TEETH_GLOOM = Gloom(4.0, 40.0, 0.15, REDDENING_EXPONENTS)
LOWER_TEETH_GLOOM = Gloom(2.0, 36.0, 0.25, REDDENING_EXPONENTS)
# The file's gums are nearly black in the notches between crowns, which are light. In the corner of
# a smile these notches were dark shapes. Gums keep this exponent of their painted shade.
LIGHTEST_GUM = np.array([0.83, 0.53, 0.51])  # sRGB, without shade: the lightest gum of the file
GUM_SHADE_EXPONENT = 0.35


class DrawnTongue(FacePart):
    """The tongue, which is darker toward the back."""

    shape: Floats64 | None = None  # array of the last `follow`

    def __init__(self, part: Part, front: float) -> None:
        """Paint a tongue; front: z of the front teeth [mm]."""
        super().__init__(replace(part, shine=0.42))  # wet
        self.front = front
        self.unlit = read_only(_painted_tongue(part))  # in full light
        self.colours = read_only(_shaded(part.vertices, self.unlit, front, TONGUE_GLOOM))

    def follow(self, now: FaceNow) -> None:
        """Set another shape and its colours; do nothing if the array is the same."""
        if now.tongue is None or now.tongue is self.shape:
            return
        self.shape = now.tongue
        self.take_shape(self.shape)
        self.colours = read_only(_shaded(self.shape, self.unlit, self.front, TONGUE_GLOOM))


class MouthWalls(FacePart):
    """The walls of the mouth, which stretch between both jaws."""

    jaw: tuple[float, ...] = ()  # values of the jaw at the last `follow`

    def __init__(self, part: Part, mandible_shares: Floats32) -> None:
        """mandible_shares: weight of the mandible's motion at each vertex, (n,)."""
        super().__init__(part)
        self.mandible_shares = mandible_shares

    def follow(self, now: FaceNow) -> None:
        """Follow the mandible; do nothing if the values of the jaw have not changed."""
        if now.jaw == self.jaw:
            return
        self.jaw = now.jaw
        if not any(now.jaw):
            self.vertices = self.rest.vertices
            self.normals = self.rest.normals
            return
        rest = self.rest.vertices.astype(np.float64)
        self.take_shape(stretched_walls(rest, self.mandible_shares, now.mandible()))


def shaded_mouth(parts: Sequence[Part]) -> tuple[HeadPart, ...]:
    """Darken parts of the mouth toward the back, and make some of them bendable."""
    front = max((part.vertices[:, 2].max() for part in parts if "teeth" in part.name), default=0.0)

    def shaded(part: Part) -> HeadPart:
        """Return a darkened part of the mouth, or another part unchanged."""
        if part.name == "tongue":
            return DrawnTongue(part, float(front))
        if part.mandible_shares is not None and part.name != MASK_NAME:
            return MouthWalls(part, part.mandible_shares)
        if not part.name.startswith(MOUTH_PART_NAMES):
            return part
        gloom = {"teeth_upper": UPPER_TEETH_GLOOM, "teeth_lower": LOWER_TEETH_GLOOM}.get(
            part.name, GUM_GLOOM
        )
        own = part.colours
        if part.name.startswith("gums"):
            own = LIGHTEST_GUM * np.clip(own / LIGHTEST_GUM, 0.0, 1.0) ** GUM_SHADE_EXPONENT
        return replace(part, colours=_shaded(part.vertices, own, front, gloom))

    return tuple(shaded(part) for part in parts)


def _painted_tongue(part: Part) -> Floats32:
    """Paint a tongue, (n, 3): red edges, a pale coat, a dark groove; chosen by eye."""
    vertices = part.vertices.astype(np.float64)
    middle = vertices[:, 0].mean()
    beside = np.abs(vertices[:, 0] - middle)
    across = beside / max(float(beside.max()), 1e-6)
    depth = vertices[:, 2].max() - vertices[:, 2]
    above = np.clip(part.normals[:, 1], 0.0, 1.0)
    groove_width = 1.6  # [mm]
    off_tip = np.clip(depth / 8.0, 0.0, 1.0)
    groove = above * np.exp(-((beside / groove_width) ** 2)) * off_tip
    off_edge = np.clip(1.0 - across / 0.7, 0.0, 1.0)
    coat = above * off_edge * np.clip((depth + 4.0) / 18.0, 0.0, 1.0)
    edge = 1.0 - above * np.clip(1.6 - 1.6 * across, 0.0, 1.0)
    grain = np.random.default_rng(0).normal(0.0, 0.04, len(vertices))
    pale = np.array([0.72, 0.55, 0.52])
    reddened = 1.0 - edge[:, None] * [0.05, 0.2, 0.2]
    darkened = 1.0 - groove[:, None] * [0.22, 0.32, 0.32]
    colours = part.colours * [0.87, 0.95, 0.94] * reddened
    colours += 0.75 * coat[:, None] * (pale - colours)
    colours *= (1.0 + grain[:, None]) * darkened
    return np.asarray(np.clip(colours, 0.0, 1.0), np.float32)


def _shaded(
    points: npt.NDArray[Any], colours: npt.NDArray[Any], front: float, gloom: Gloom
) -> Floats32:
    """Darken colours (n, 3) behind the front teeth."""
    behind = (front - points[:, 2] - gloom.begins) / (gloom.ends - gloom.begins)
    fraction = np.clip(behind, 0.0, 1.0)
    light = 1.0 - gloom.lost * fraction * fraction * (3.0 - 2.0 * fraction)
    seen: Floats32 = (colours * light[:, None] ** np.array(gloom.powers)).astype(np.float32)
    return seen
