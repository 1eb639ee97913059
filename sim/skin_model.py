"""The skin data for the kernels of a substep, and the values that are constant during a tick.

Source: Kähler et al. 2001, section 3: point masses at the vertices, joined by springs.
"""

from __future__ import annotations

from typing import NamedTuple

from ..geometry.arrays import Floats64
from .contact import Grip, LipPairs
from .eye_contact import EyeContact
from .skull import RigidMotion
from .teeth import Teeth
from .tissue import EdgeSprings, TissueSprings


class SkinModel(NamedTuple):
    """Point masses, springs and contacts of one face; a simulation does not change them."""

    rest: Floats64  # (V, 3) mm, positions of the undeformed mesh
    mass: Floats64  # (V,)
    tissue: TissueSprings
    edges: EdgeSprings
    lips: LipPairs
    eyes: EyeContact
    teeth: Teeth


class Tick(NamedTuple):
    """Values that stay constant during one tick."""

    substeps: int
    h: float  # s, length of each
    grip: Grip  # how firmly the lips hold each other
    mandible: RigidMotion
    looks: Floats64  # (eyes, 3) unit, along which each eyeball looks
