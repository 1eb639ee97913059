"""Undo and redo: a row of states that never change, and a place in it."""

from __future__ import annotations

from typing import Generic, TypeVar

State = TypeVar("State")
MOST = 200  # states; a state is some kilobytes


class History(Generic[State]):
    """The states that there were; the last one noted is the present."""

    def __init__(self, present: State) -> None:
        self._states = [present]
        self._place = 0

    @property
    def can_undo(self) -> bool:
        """Whether there is something before the present."""
        return self._place > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return self._place < len(self._states) - 1

    @property
    def present(self) -> State:
        """The state noted last, or come back to."""
        return self._states[self._place]

    def note(self, state: State) -> None:
        """Something was done; what was undone before is forgotten. Equal states count once."""
        if state == self.present:
            return
        self._states = [*self._states[: self._place + 1], state][-MOST:]
        self._place = len(self._states) - 1

    def undo(self) -> State:
        """Step back, as far as there is something."""
        self._place = max(self._place - 1, 0)
        return self.present

    def redo(self) -> State:
        """Step forward, as far as there is something."""
        self._place = min(self._place + 1, len(self._states) - 1)
        return self.present
