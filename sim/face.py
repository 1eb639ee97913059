"""The face as a mass-spring system: one `Simulation`, stepped by contraction values.

    controls  ->  activations                                            controls.py
                      |
    jaw, gaze  ->  bones and lids carry the tissue springs' far ends     skull.py, lids.py
    muscles    ->  one anchor per skin vertex                            muscles.py, fibres.py
                      |
    tissue + edges + lip seal  ->  velocity  ->  position                tissue.py, substep.py
    lips and eyeballs keep skin out                                      contact.py, substep.py

Built once from a mesh (face_model.py), then `step` moves it. Everything inside runs in the standard
face space, fixed to the cranium; only displacements are turned back into the head's own
coordinates, so a face at rest has exactly the positions it came with. The pose of the head moves
the result as a whole, but for the foot of the neck.

Source: Kähler, Haber, Seidel 2001, "Geometry-based muscle modeling for facial animation"; Kähler
et al. 2003, Figure 1 (left half).
Differs from it: see the modules named above.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from ..schema import quoted
from . import checked
from .contact import SEALED
from .controls import Controls, MuscleDrive
from .coordinates import to_posed_head
from .face_model import FaceModel, Tick
from .landmarks import Array
from .layers import Layers
from .lids import turn_lids
from .skull import Bones
from .state import State
from .substep import LONGEST_FRAME, advance, substeps_in, ticks_in
from .tissue import carry

FINGER_RATE = 350.0  # rad/s of the firmest pull: outdoes the skin, stable at the longest substep


class SimulationUnstable(RuntimeError):  # noqa: N818, the name the whole project uses
    """A position is no longer a finite number: the input was broken, or the model has an error."""


class Finger:
    """Draws at the skin of one simulation: springs from vertices, or none, to where they go."""

    def __init__(self) -> None:
        self.let_go()

    def hold(self, vertices: npt.NDArray[np.int64], to: Array, stiffness: Array) -> None:
        """Draw vertices, by their numbers (n,), to places (n, 3) of the standard space."""
        self._vertices, self._to, self._stiffness = vertices, to, stiffness

    def let_go(self) -> None:
        """Hold nothing."""
        self.hold(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0))

    def add(self, state: State) -> None:
        """Add the springs to what holds and pulls the skin."""
        if len(self._vertices):
            drawn = self._to - state.carried[self._vertices]
            state.hold[self._vertices] += self._stiffness
            state.pull[self._vertices] += self._stiffness[:, None] * drawn


class Simulation(Controls):
    """A face that follows its controls; made by `sim.create`."""

    def __init__(self, model: FaceModel) -> None:
        self._model = model
        super().__init__(model.controls, model.layers)
        surface = model.surface
        self._state = State.at_rest(surface)
        self._grip = SEALED
        self._bones, self._finger = Bones(model.skull, model.space), Finger()
        self._axes = model.space.axes * model.space.scale
        self._drive = MuscleDrive(model.rig, model.muscles.names, self)
        self._rest = model.vertices.copy()
        self._positions = model.vertices.copy()
        self._rest.flags.writeable = False
        self._resting_tongue: Array | None = None
        if model.tongue is not None:
            self._resting_tongue = model.space.to_head(model.tongue.rest)
            self._resting_tongue.flags.writeable = False
        self._view = self._positions.view()
        self._view.flags.writeable = False
        self._place_targets()

    @property
    def tables(self) -> Layers:
        """What each control of the layers adds to the C lowest `controls`, in their order."""
        return self._model.layers

    @property
    def positions(self) -> npt.NDArray[np.float64]:
        """Vertex positions now [head units], shape (V, 3); a read-only view, `step` rewrites it."""
        return self._view

    @property
    def rest_positions(self) -> npt.NDArray[np.float64]:
        """Vertex positions at rest [head units], shape (V, 3); read-only."""
        return self._rest

    @property
    def mandible_weight(self) -> npt.NDArray[np.float64]:
        """How far each vertex goes with the mandible, 0 to 1, shape (V,); given or guessed."""
        return self._model.skull.mandible_weight

    @property
    def head_weight(self) -> npt.NDArray[np.float64]:
        """How far each vertex goes with the head's pose, 1, fading to 0 down the neck, (V,)."""
        return self._model.turns[:, 0]

    @property
    def areas(self) -> Array:
        """Skin that belongs to each vertex at rest [mm2 of the standard face], shape (V,)."""
        return self._model.surface.areas

    @property
    def faces(self) -> npt.NDArray[np.int32]:
        """Triangles, shape (F, 3); they never change."""
        return self._model.surface.faces

    def reset(self) -> None:
        """Relax everything and put the face back to rest at once."""
        super().reset()
        self._state.x[:] = self._model.surface.positions
        self._state.v[:] = 0.0
        self._positions[:] = self._rest
        self._finger.let_go()
        self._place_targets()

    def clone(self) -> Simulation:
        """Another simulation of this face as it is now, of which no finger has hold."""
        clone = Simulation(self._model)
        clone.copy_from(self)
        return clone

    def copy_from(self, other: Simulation) -> None:
        """Take on controls, positions and velocities of a clone; ValueError for any other."""
        if not isinstance(other, Simulation) or other._model is not self._model:
            raise ValueError(f"other: was {quoted(other)}, must be a clone of this face")
        self._copy(other)
        self._state.x[:], self._state.v[:] = other._state.x, other._state.v
        self._positions[:] = other._positions

    def jump(self, values: Mapping[str, float]) -> None:
        """Set several controls, and let all muscles and bones obey at once; the skin follows."""
        self.set_all(values)
        self._arrive()
        self._state.v[:] = 0.0

    def kick(self, velocities: npt.ArrayLike) -> None:
        """Add velocities [head units / s], shape (V, 3): a blow.

        Raises ValueError for another shape, and for what is not finite.
        """
        added = checked.numbers("velocities", velocities, self._state.v.shape)
        turned = self._model.space.vectors_to_standard(added) @ self._bones.head.rotation
        self._state.v[:] += turned

    def drag(
        self, vertices: npt.ArrayLike, targets: npt.ArrayLike, firmness: npt.ArrayLike
    ) -> None:
        """Hang vertices on springs until the next `drag` or `end_drag`: a finger draws at the skin.

        vertices: their numbers, shape (n,), none twice. targets: where each is drawn to [head
        units], shape (n, 3). firmness: of each spring, 0 (none) .. 1 (holds against any muscle),
        shape (n,). Raises ValueError where they do not fit together.
        """
        numbers, points, share = checked_drag(vertices, targets, firmness, len(self._rest))
        away = self._model.space.vectors_to_standard(points - self._positions[numbers])
        to = self._state.x[numbers] + away @ self._bones.head.rotation
        self._finger.hold(numbers, to, share * self._model.skin.mass[numbers] * FINGER_RATE**2)

    def end_drag(self) -> None:
        """End every `drag`; the skin swings back."""
        self._finger.let_go()

    def step(self, dt: float) -> None:
        """Advance by `dt` [s], 0 < dt <= 1/20; ValueError otherwise.

        Raises SimulationUnstable if a position is no longer finite.
        """
        dt = checked.number("dt", dt)
        if not 0.0 < dt <= LONGEST_FRAME + 1e-9:
            raise ValueError(
                f"dt: was {dt!r} s, must be above 0 and at most {LONGEST_FRAME:g} s; "
                "take several steps for a longer time"
            )
        model, state, bones = self._model, self._state, self._bones
        ticks = ticks_in(dt)
        tick = dt / ticks
        count = substeps_in(tick)
        for _ in range(ticks):
            self._advance(tick / 2.0)
            self._place_targets()
            advance(state, model.skin, Tick(count, tick / count, self._grip, bones.mandible))
            self._advance(tick / 2.0)
        broken = to_posed_head(
            state.x, model.surface.positions, self._axes, self._rest, bones.turn, model.turns,
            self._positions,
        )  # fmt: skip
        if broken:
            raise SimulationUnstable(
                f"{broken} of {len(state.x)} vertices are not finite; "
                "call reset(), and report the mesh if it was built from a sound one"
            )

    def _place_targets(self) -> None:
        """Bones, lids and muscles for the activations reached: where each spring pulls to."""
        model, now, bones = self._model, self._now, self._bones
        state, surface, muscles = self._state, model.surface, model.muscles
        bones.follow(now)
        weight, closed = model.skull.mandible_weight, now("lips_closed")
        if closed > 0.0:
            weight = weight + closed * (model.closed_weight - weight)
        carry(state, surface.positions, surface.normals, weight, bones.mandible)
        state.hold[:] = model.passive_hold
        state.pull[:] = 0.0
        if model.lids is not None:
            drive = model.lids.drive(self.activation)
            angles = np.radians(model.skull.eyes.gaze_deg) * bones.gaze(now)
            turn_lids(state, surface.positions, model.lids.vertices, drive, angles)
        activation = self._drive.activation()
        muscles.add(self._drive.pull(activation), bones.mandible, weight, state)
        self._finger.add(state)
        self._grip = model.grip(activation, bones.jaw, closed)

    def bone_transforms(self) -> dict[str, npt.NDArray[np.float64]]:
        """Motion of each bone from rest to now, name -> (4, 4) for column vectors [head units]."""
        return self._bones.transforms(self._now)

    def pivots(self) -> dict[str, npt.NDArray[np.float64]]:
        """What each bone turns about at rest, name of `bone_transforms` -> (3,) [head units]."""
        return self._bones.pivots()

    def tongue(self) -> npt.NDArray[np.float64] | None:
        """Vertices of the part "tongue" now, shape (T, 3); None for a head without one.

        As the mandible's motion finds them: its bone's matrix has still to be applied. A tongue at
        rest is the same array each time.
        """
        model, now = self._model, self._now
        if model.tongue is None:
            return None
        out, up = max(now("tongue_out"), 0.0), max(now("tongue_up"), 0.0)
        if out == up == 0.0:
            return self._resting_tongue
        bent = model.tongue.bent(out, up, self._state.x, self._bones.mandible)
        return model.space.to_head(bent)

    def fibres(self) -> dict[str, list[npt.NDArray[np.float64]]]:
        """Contracted muscle fibres now, control name -> polylines (n, 3) [head units], to draw."""
        pull = self._drive.pull(self._drive.activation())
        lines = self._model.muscles.lines(pull, self._bones.mandible, self._state.x)
        space, head = self._model.space, self._bones.head
        return {
            name: [space.to_head(line + head.displacements(line)) for line in found]
            for name, found in lines.items()
        }

    def penetrations(self) -> dict[str, float]:
        """How deep skin sits in what it must not enter, at most, less than at rest [mm].

        Names: "lips" (in the other lip, more than sealed lips are pressed together), "lids" (in an
        eyeball), "teeth".
        """
        skin, x = self._model.skin, self._state.x
        return {
            "lips": skin.lips.deepest(x, skin.rest, self._grip.overlap),
            "lids": skin.eyes.deepest(x),
            "teeth": skin.teeth.deepest(x, self._bones.mandible),
        }


def checked_drag(
    vertices: npt.ArrayLike, targets: npt.ArrayLike, firmness: npt.ArrayLike, count: int
) -> tuple[npt.NDArray[np.int64], Array, Array]:
    """What a finger was told, of a mesh with `count` vertices; ValueError where it does not fit."""
    wanted = "different vertex numbers, shape (n,)"
    numbers = checked.vertex_numbers("vertices", vertices, (None,), count, wanted)
    points = checked.numbers("targets", targets, (len(numbers), 3))
    share = checked.numbers("firmness", firmness, (len(numbers),))
    if not ((share >= 0.0) & (share <= 1.0)).all():
        raise ValueError(
            f"firmness: runs from {share.min():g} to {share.max():g}, must be from 0 to 1"
        )
    if len(np.unique(numbers)) < len(numbers):
        raise ValueError(f"vertices: some are there twice, must be {wanted}")
    return numbers, points, share
