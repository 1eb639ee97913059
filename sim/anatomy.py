"""The parts under the current skin of a face, for drawing and measuring; they do not move it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from .bones import Bones
from .controls import Controls, MuscleDrive
from .face_model import FaceModel
from .muscles import LineHold
from .polylines import polyline_distance
from .state import State


class Anatomy:
    """Contracted muscles, the tongue, and the depth by which skin penetrates other parts."""

    def __init__(
        self, model: FaceModel, state: State, controls: Controls, bones: Bones, drive: MuscleDrive
    ) -> None:
        self._model = model
        self._state = state
        self._bones = bones
        self._drive = drive
        self._controls = controls
        self._held: list[LineHold] | None = None  # for courses, at their first use
        self._tongue = controls.places_in_reached(("tongue_out", "tongue_up"))
        if model.tongue is not None:
            self._resting_tongue = model.space.to_head(model.tongue.rest)
            self._resting_tongue.flags.writeable = False

    def tongue(self) -> Floats64 | None:
        """Vertices of the part "tongue" now, shape (T, 3); None for a head without a tongue.

        They are in the space of the mandible: multiply them by the matrix of this bone. A tongue at
        rest is always the same array.
        """
        model = self._model
        if model.tongue is None:
            return None
        out, up = np.maximum(self._controls.reached[self._tongue], 0.0).tolist()
        if out == up == 0.0:
            return self._resting_tongue
        return model.space.to_head(model.tongue.bent(out, up, self._state.x, self._bones.mandible))

    def fibres(self) -> dict[str, list[Floats64]]:
        """Fibres, contracted as if nothing resisted: name -> polylines (n, 3) [head units]."""
        pull = self._drive.pull(self._drive.activation())
        return self._in_head(self._model.muscles.lines(pull, self._bones.mandible, self._state))

    def courses(self) -> dict[str, list[Floats64]]:
        """Lines along the muscles now, for drawing: control name -> polylines (n, 3) [head units].

        Their ends stay in the skin, although skin follows only a part of a contraction.
        """
        model = self._model
        muscles = model.muscles
        rest = model.skin.rest
        if self._held is None:
            self._held = muscles.holds_of_lines(rest)
        lines = muscles.courses(self._bones.mandible, self._state.x, rest, self._held)
        return self._in_head(lines)

    def _in_head(self, lines: dict[str, list[Floats64]]) -> dict[str, list[Floats64]]:
        """Convert lines [mm] to head units, turned with the head."""
        space = self._model.space
        head = self._bones.head
        turned = {}
        for name, found in lines.items():
            turned[name] = [space.to_head(line + head.displacements(line)) for line in found]
        return turned

    def muscle_at(self, point: npt.ArrayLike, reach: float) -> str | None:
        """The muscle whose fibres come nearest to a point (3,) of the skin, within `reach`.

        Muscles of the other side do not count, because sphincters of both sides lie in both lips.
        """
        at = np.asarray(point, np.float64)[None]
        (skin,) = self._in_head({"skin": [self._state.x]})["skin"]
        touched = np.square(skin - at).sum(axis=1).argmin()
        other_side = "_right" if self._model.skin.rest[touched, 0] > 0.0 else "_left"
        nearest = None
        least = np.inf
        for name, lines in self.courses().items():
            if name.endswith(other_side):
                continue
            for line in lines:
                # The last point is repeated, because a fibre may be a single point.
                distance = polyline_distance(at, np.vstack([line, line[-1:]]))[0]
                if distance < least:
                    nearest = name
                    least = distance
        return nearest if least <= reach else None

    def penetrations(self) -> dict[str, float]:
        """Greatest depth of skin in other lip, eyeballs and teeth, minus the depth at rest [mm].

        Names: "lips" (depth in the other lip, beyond the overlap of sealed lips), "lids" (depth in
        an eyeball), "teeth".
        """
        skin = self._model.skin
        x = self._state.x
        bones = self._bones
        grip = self._model.grip(self._drive.activation(), bones.jaw, bones.lips_closed)
        return {
            "lips": skin.lips.deepest(x, skin.rest, grip.overlap),
            "lids": skin.eyes.deepest(x, bones.looks()),
            "teeth": skin.teeth.deepest(x, bones.mandible),
        }
