"""Undo and redo: a row of states that never change, each with what was done, and a place in it."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Generic, TypeVar

State = TypeVar("State")
MOST = 200  # states
MOST_GROWTH = 5_000_000  # keys that are not shared with the state before, each some 50 bytes


class History(Generic[State]):
    """The states that there were; the last one noted is the present."""

    def __init__(self, present: State, growth: Callable[[State, State], int]) -> None:
        """growth: how many keys the second of two states has that the first does not share."""
        self._states = [present]
        self.labels = ["Beginning"]  # what was done to come to each state
        self.place = 0  # of the present among them
        self._growth = growth

    @property
    def can_undo(self) -> bool:
        """Whether there is something before the present."""
        return self.place > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return self.place < len(self._states) - 1

    @property
    def present(self) -> State:
        """The state noted last, or come back to."""
        return self._states[self.place]

    def note(
        self, state: State, label: str = "", onto: Callable[[State], State] | None = None
    ) -> None:
        """Something was done; what was undone before is forgotten. Equal states count once.

        label: what was done, as "Mirror". onto: given where nothing is forgotten; what each state
        is that can be done again after this.
        """
        if state == self.present:
            return
        end = self.place + 1
        later = [*map(onto, self._states[end:])] if onto else []
        labels = self.labels[end:][: len(later)]
        self._states[end:], self.labels[end:] = [state], [label]
        while len(self._states) > MOST or (len(self._states) > 2 and self._are_too_large):
            del self._states[0], self.labels[0]
        self.place = len(self._states) - 1
        self._states += later
        self.labels += labels

    def amend(self, state: State) -> None:
        """The present is this now, which nobody would call a step."""
        self._states[self.place] = state

    @property
    def _are_too_large(self) -> bool:
        return sum(itertools.starmap(self._growth, itertools.pairwise(self._states))) > MOST_GROWTH

    def go(self, place: int) -> State:
        """To the state of this number, or as near as there is one."""
        self.place = min(max(place, 0), len(self._states) - 1)
        return self.present
