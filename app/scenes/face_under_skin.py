"""A head with its simulation, and the skin that the simulation moves.

If a head has too many triangles to simulate in real time, a simplified mesh is simulated, and the
head's own vertices follow this mesh (dense_skin.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from risorius import assets, sim
from risorius.assets.annotation import Annotation, annotation_of
from risorius.assets.fitting import FittedHead, SimulatedHead
from risorius.assets.fitting.own_lip import lip_sides
from risorius.geometry.arrays import Floats64

from .dense_skin import DenseSkin


@dataclass(frozen=True, eq=False)
class Face:
    """A head, its simulation, and a dense skin if the simulated mesh is simplified."""

    head: assets.Head | FittedHead
    simulation: sim.Simulation
    dense_skin: DenseSkin | None = None

    @classmethod
    def from_head(cls, head: assets.Head | FittedHead) -> Face:
        """Make a face of this head at rest; raises ValueError if it cannot be simulated."""
        simplified = head.simplified if isinstance(head, FittedHead) else None
        simulation = sim.create(simplified or head)
        if simplified is None:
            return cls(head, simulation)
        own, coarse = (
            lip_sides(each.vertices, each.faces, each.landmarks) for each in (head, simplified)
        )
        return cls(
            head, simulation, DenseSkin(head.vertices, head.faces, simulation, (own, coarse))
        )

    def clone(self) -> Face:
        """Return a copy of the face at rest, which moves independently."""
        simulation = self.simulation.clone()
        simulation.reset()
        twin = replace(
            self,
            simulation=simulation,
            dense_skin=None if self.dense_skin is None else self.dense_skin.clone(),
        )
        twin.follow()
        return twin

    @property
    def simulated_head(self) -> assets.Head | FittedHead | SimulatedHead:
        """The head on whose vertices the simulation runs."""
        simplified = self.head.simplified if isinstance(self.head, FittedHead) else None
        return simplified or self.head

    @property
    def rest_positions(self) -> Floats64:
        """The vertices of the skin at rest [mm], shape (V, 3)."""
        simulated: Floats64 = self.simulation.rest_positions
        return simulated if self.dense_skin is None else self.dense_skin.rest_positions

    @property
    def positions(self) -> Floats64:
        """The current vertices of the skin [mm], shape (V, 3); always the same view.

        A dense skin is computed when this is read.
        """
        simulated: Floats64 = self.simulation.positions
        return simulated if self.dense_skin is None else self.dense_skin.positions

    @property
    def head_weight(self) -> Floats64:
        """How far each vertex turns with the head, 0 to 1, shape (V,)."""
        weight: Floats64 = self.simulation.bones.head_weight
        return weight if self.dense_skin is None else self.dense_skin.carry(weight)

    @property
    def marked(self) -> Floats64:
        """The current positions of the rig's 68 landmarks [mm], shape (68, 3)."""
        return np.asarray(self.positions[self.head.landmarks])

    @cached_property
    def annotation(self) -> Annotation:
        """The points of this head that annotators of pictures mark as the 68 points of iBug."""
        return annotation_of(self.head)

    def follow(self) -> None:
        """Let a dense skin follow the current simulated mesh."""
        if self.dense_skin is not None:
            self.dense_skin.follow(self.simulation.positions)

    def bone_transforms(self) -> Mapping[str, Floats64]:
        """Return the current place of each bone, a matrix (4, 4)."""
        return self.simulation.bones.transforms()
