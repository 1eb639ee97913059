"""What a substep reads: the skin at rest with all that holds it, and what a tick fixes.

Source: Kähler et al. 2001, section 3 (the skin as a mass-spring mesh).
"""

from __future__ import annotations

from typing import NamedTuple

from .contact import EyeContact, Grip, LipPairs
from .landmarks import Array
from .skull import RigidMotion
from .springs import EdgeSprings
from .teeth import Teeth
from .tissue import TissueSprings


class SkinModel(NamedTuple):
    """Point masses, springs and contacts of one face; none of it changes while it is simulated."""

    rest: Array  # (V, 3) mm, positions of the undeformed mesh
    mass: Array  # (V,)
    tissue: TissueSprings
    edges: EdgeSprings
    lips: LipPairs
    eyes: EyeContact
    teeth: Teeth


class Tick(NamedTuple):
    """What holds during one tick."""

    substeps: int
    h: float  # s, length of each
    grip: Grip  # how firmly the lips hold each other
    mandible: RigidMotion
