"""The face as a mass-spring system: one `Simulation`, stepped by contraction values.

    controls  ->  activations                                            controls.py
                      |
    jaw, gaze  ->  bones and lids carry the tissue springs' far ends     skull.py, lids.py
    muscles    ->  one anchor per skin vertex                            muscles.py, fibres.py
                      |
    tissue + edges + lip seal  ->  velocity  ->  position                tissue.py, substep.py
    lips and eyeballs keep skin out                                      contact.py, eye_contact.py

A face is built once from a mesh (face_model.py), then `step` moves it. The simulation runs in the
standard face space, fixed to the cranium. Only displacements are mapped back to head coordinates,
so a face at rest has exactly its input positions. The pose of the head moves the result as a whole,
except the base of the neck.

Source: Kähler, Haber, Seidel 2001, "Geometry-based muscle modeling for facial animation"; Kähler
et al. 2003, Figure 1 (left half).
The modules named above list the differences.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.read_only import read_only
from ..schema import quoted
from . import checked
from .anatomy import Anatomy
from .bones import Bones
from .contact import SEALED_GRIP
from .controls import Controls, MuscleDrive
from .coordinates import to_posed_head
from .face_model import FaceModel
from .lid_motion import turn_lids
from .skin_model import Tick
from .state import State
from .substep import LONGEST_FRAME, advance, substeps_in, ticks_in
from .tissue import carry
from .touch import Touch


class SimulationUnstable(RuntimeError):  # noqa: N818, the name the whole project uses
    """A position is no longer a finite number: the input was broken, or the model has an error."""


class Simulation:
    """A simulated face that follows its controls; made by `sim.create`.

    controls: muscles, jaw, gaze, and the layers above.
    bones: the poses of jaw and eyeballs.
    anatomy: the current parts under the skin.
    touch: impulses on the skin, and springs that pull it.
    positions: current vertices [head units], shape (V, 3), read only; `step` rewrites them.
    rest_positions: vertices at rest [head units], shape (V, 3), read only.
    faces: triangles, shape (F, 3), read only.
    areas: area of each vertex's skin at rest [mm2 of the standard face], shape (V,), read only.
    grip: how firmly the lip seal holds now.
    """

    def __init__(self, model: FaceModel, state: State | None = None) -> None:
        """state: the arrays that kernels read and write; None creates a state at rest."""
        surface = model.surface
        self._state = state or State.at_rest(surface, len(model.muscles.bundle.muscle))
        self._model = model
        self.grip = SEALED_GRIP
        self._positions = model.vertices.copy()
        self.positions = read_only(self._positions)
        self.rest_positions = read_only(model.vertices.copy())
        self.faces = read_only(surface.faces)
        self.areas = read_only(surface.areas)
        self._axes = model.space.axes * model.space.scale
        self.controls = Controls(model.controls, model.layers)
        self.bones = Bones(model, self.controls)
        self._drive = MuscleDrive(model.rig, model.muscles.names, self.controls)
        self.anatomy = Anatomy(model, self._state, self.controls, self.bones, self._drive)
        self.touch = Touch(model, self._state, self.positions, self.bones)
        self._placed_for: Floats64 | None = None  # activations; None: place targets anew
        self.place_targets()

    def reset(self) -> None:
        """Set all controls to 0, and move the face to rest at once."""
        self.controls.reset()
        self._state.x[:] = self._model.surface.positions
        self._state.v[:] = 0.0
        self._positions[:] = self.rest_positions
        self.touch.end_drag()
        self.place_targets()

    def clone(self) -> Simulation:
        """Return a copy of this simulation in its current state, without pulls on its skin."""
        clone = Simulation(self._model)
        clone.copy_from(self)
        return clone

    def copy_from(self, other: Simulation) -> None:
        """Copy controls, positions and velocities of a clone; else raises ValueError."""
        if not isinstance(other, Simulation) or other._model is not self._model:
            raise ValueError(f"other: was {quoted(other)}, must be a clone of this face")
        self.controls.copy_from(other.controls)
        self._state.x[:] = other._state.x
        self._state.v[:] = other._state.v
        self._positions[:] = other._positions

    def jump(self, values: Mapping[str, float]) -> None:
        """Set several controls; muscles and bones move at once, the skin follows over time."""
        self.controls.set_all(values)
        self.controls.arrive()
        self._state.v[:] = 0.0

    def step(self, dt: float) -> None:
        """Advance by `dt` [s], 0 < dt <= 1/20; raises ValueError otherwise.

        Raises SimulationUnstable if a position is no longer finite.
        """
        dt = checked.number("dt", dt)
        if not 0.0 < dt <= LONGEST_FRAME + 1e-9:
            raise ValueError(
                f"dt: was {dt!r} s, must be above 0 and at most {LONGEST_FRAME:g} s; "
                "take several steps for a longer time"
            )
        model = self._model
        state = self._state
        bones = self.bones
        ticks = ticks_in(dt)
        tick = dt / ticks
        count = substeps_in(tick)
        for _ in range(ticks):
            self.controls.advance(tick / 2.0)
            if not self._are_targets_there():
                self.place_targets()
            advance(
                state,
                model.skin,
                Tick(count, tick / count, self.grip, bones.mandible, self._looks),
            )
            self.controls.advance(tick / 2.0)
        broken = to_posed_head(
            state.x, model.surface.positions, self._axes, self.rest_positions, bones.turn,
            model.turns, self._positions,
        )  # fmt: skip
        if broken:
            raise SimulationUnstable(
                f"{broken} of {len(state.x)} vertices are not finite; "
                "call reset(), and report the mesh if it was built from a sound one"
            )

    def _are_targets_there(self) -> bool:
        """Whether targets are placed for these activations, and no finger pulls the skin."""
        if self._placed_for is None or self.touch.is_held:
            return False
        return bool((self._placed_for == self.controls.reached).all())

    def place_targets(self) -> None:
        """Compute the spring targets from bones, lids and muscles at the current activations."""
        model = self._model
        bones = self.bones
        state = self._state
        muscles = self._model.muscles
        bones.follow()
        self._looks = bones.looks()
        rest = model.surface.positions
        normals = model.surface.normals
        carry(state, rest, normals, bones.weight, bones.mandible)
        state.hold[:] = model.passive_hold
        state.pull[:] = 0.0
        if model.lids is not None:
            drive = model.lids.drive(self.controls.activation)
            angles = np.radians(model.skull.eyes.gaze_deg) * bones.gaze()
            angles *= model.lids.vertices.gaze_fraction[:, None]
            turn_lids(state, rest, model.lids.vertices, drive, angles)
        activation = self._drive.activation()
        muscles.add(self._drive.pull(activation), bones.mandible, bones.weight, state)
        self.touch.add_to(state)
        self._placed_for = None if self.touch.is_held else self.controls.reached.copy()
        self.grip = model.grip(activation, bones.jaw, bones.lips_closed)
