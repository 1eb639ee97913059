"""The state of a face while it is simulated, as arrays that the kernels share.

One `State` belongs to one simulation and is allocated once; kernels take it whole and write into
its arrays. Coordinates are the standard space of coordinates.py [mm, mm/s].

Source: Kähler et al. 2001: point masses at the vertices, moved by the springs attached to them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64
from .fibres import LineMotion
from .surface import SkinSurface


class State(NamedTuple):
    """Positions, velocities, targets of springs, and work space, for each vertex or edge."""

    x: Floats64  # (V, 3) positions
    v: Floats64  # (V, 3) velocities
    carried: Floats64  # (V, 3) rest carried by bones and lids: far ends of the tissue springs
    normals: Floats64  # (V, 3) tissue directions, carried by the same bones
    hold: Floats64  # (V,) stiffness of muscles and lids
    pull: Floats64  # (V, 3) force of active muscles
    offset: Floats64  # (V, 3) x - carried
    force: Floats64  # (V, 3) sum of all forces
    decay: Floats64  # (V,) share of the velocity that damping leaves in a substep
    gain: Floats64  # (V,) velocity gained per force in a substep
    work: Floats64  # (V, 3) work space; its content does not outlive a kernel
    tension: Floats64  # (E,) of each edge spring, divided by its length
    lines: LineMotion  # of the muscles

    @classmethod
    def at_rest(cls, surface: SkinSurface, line_count: int = 0) -> State:
        """A face at rest, whose muscles have this many lines."""
        scalar = surface.vertex_count
        vector = (surface.vertex_count, 3)
        return cls(
            x=surface.positions.copy(),
            v=np.zeros(vector),
            carried=surface.positions.copy(),
            normals=surface.normals.copy(),
            hold=np.zeros(scalar),
            pull=np.zeros(vector),
            offset=np.zeros(vector),
            force=np.zeros(vector),
            decay=np.zeros(scalar),
            gain=np.zeros(scalar),
            work=np.zeros(vector),
            tension=np.zeros(len(surface.edges)),
            lines=LineMotion.allocate(line_count),
        )
