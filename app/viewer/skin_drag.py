"""A finger on the skin: it pulls, and the muscles that hold the skin there are solved meanwhile.

Dragged skin hangs on springs between the vertices under the mouse and where it drags. Muscles and
jaw follow (sim.Pull), and hold it when the springs go.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import sim

from ..mirror import parted, twin_of
from .control_rows import OPPOSITE, readable
from .messages import Message
from .picking import muscle_at
from .session import Session

FINGER = 16.0  # [mm] the finger's radius
FARTHEST = 45.0  # [mm] that a finger drags, lest the skin turns inside out
NOT_PULLED = ("gaze_", "head_", "tongue_", "lips_closed")  # controls that no finger on skin means
MOST_TOLD = 4  # controls in a message

FloatArray = npt.NDArray[np.float64]


class SkinDrag:
    """A finger that holds on to the skin."""

    def __init__(
        self,
        session: Session,
        point: FloatArray,
        sight: FloatArray,
        *,
        linked: bool = False,
        is_only_pulled: bool = False,
    ) -> None:
        """sight: direction in which the point is seen. linked: both sides of a muscle obey.

        is_only_pulled: no muscle shall hold the skin; nor may one while a live face leads.
        """
        self._session, self._sight = session, sight
        self._scene: Any = session.scene
        self.point = point
        positions = self._scene.positions
        distance = np.linalg.norm(positions - point, axis=1)
        self._vertices = np.flatnonzero(distance < FINGER)
        if not len(self._vertices):
            self._vertices = distance.argmin(keepdims=True)
        self._from = positions[self._vertices].copy()
        near = distance[self._vertices] / FINGER
        self._firmness = (
            np.maximum((1.0 - near**2) ** 2, 0.02) if near.max() < 1.0 else near * 0 + 1
        )
        self.offset = np.zeros(3)
        poses = not (is_only_pulled or session.live.is_on)
        self._candidates = _candidates(session, linked=linked) if poses else []
        self._own = {name: session.values[name] for names in self._candidates for name in names}
        self._pull: sim.Pull | None = None  # from the first motion on: a click need not wait

    def to(self, point: FloatArray) -> None:
        """Drag to a point, or toward it if that is too far; once in each frame."""
        simulation = self._scene.simulation
        if self._pull is None and self._candidates:
            finger = self._vertices, self._firmness
            self._pull = sim.Pull(simulation, *finger, self._candidates, self._sight)
            self._at_rest = self._pull.targets
        offset = point - self.point
        length = float(np.linalg.norm(offset))
        self.offset = offset * (FARTHEST * np.tanh(length / FARTHEST) / max(length, 1e-9))
        simulation.drag(self._vertices, self._from + self.offset, self._firmness)
        if self._pull is not None:
            self._pull.targets = self._at_rest + self.offset
            self._pull.follow()
            self._obey(self._pull)

    def muscle(self) -> str | None:
        """The one under the finger, if any."""
        return muscle_at(self.point, self._scene.simulation.fibres())

    def let_go(self) -> Message:
        """The skin stays where muscles hold it, and swings back else; what was solved."""
        self._scene.simulation.end_drag()
        pull = self._pull
        if pull is None or not self.offset.any():
            return None
        pull.solve()
        self._obey(pull)
        self._session.note()
        if not pull.changes:
            return "No muscle draws the skin this way: it swings back"
        told = [f"{_called(names)} {value:.2f}" for names, value in pull.changes.items()]
        more = [f"{len(told) - MOST_TOLD} more"] if len(told) > MOST_TOLD else []
        line = ", ".join([*told[:MOST_TOLD], *more])
        return f"{line[0].upper()}{line[1:]}; {pull.short:.1f} mm short"

    def _obey(self, pull: sim.Pull) -> None:
        """Set what was solved, and put back what was set before and is needed no more."""
        solved = {name: value for names, value in pull.changes.items() for name in names}
        for name, own in self._own.items():
            if solved.get(name, own) != self._session.values[name]:
                self._session.set(name, solved.get(name, own))


def _candidates(session: Session, *, linked: bool) -> list[tuple[str, ...]]:
    """The controls that a finger on the skin may move, in one tuple those that go together."""
    found: list[tuple[str, ...]] = []
    controls = session.scene.simulation.controls  # type: ignore[attr-defined]
    for name in controls:
        twin = twin_of(name)
        is_whole = f"{name}_left" in controls
        if is_whole or name.startswith(NOT_PULLED):
            continue
        is_pair = linked and twin != name and session.values[name] == session.values[twin]
        if not is_pair or parted(name)[0] in OPPOSITE:
            found.append((name,))
        elif name < twin:
            found.append((name, twin))
    return found


def _called(names: tuple[str, ...]) -> str:
    return readable(names[0]) if len(names) == 1 else f"{readable(parted(names[0])[0])} (both)"
