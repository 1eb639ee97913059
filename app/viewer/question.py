"""The question before work is lost; what it looks like is in panels/question_box.py."""

from __future__ import annotations

from typing import Protocol

from .messages import Message, Task
from .session import Session


class Unsaved(Protocol):
    """Work beside the session's, which may be lost, too."""

    @property
    def unsaved(self) -> str:
        """What would be lost, in words; "" for nothing."""

    def save(self, then: Task) -> Message:
        """Save it, and go on."""


class Question:
    """Asks before unsaved work is lost: save it, lose it, or go back."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.task: Task | None = None  # what waits for the answer
        self.verb = ""  # for it, as "Close"
        self.other: Unsaved | None = None  # what else the window works on
        self._is_of_other = False  # whether that alone would be lost

    @property
    def is_open(self) -> bool:
        """Whether an answer is awaited."""
        return self.task is not None

    @property
    def unsaved(self) -> str:
        """What would be lost, in words; "" for nothing."""
        both = (self.unsaved_session, self.other.unsaved if self.other is not None else "")
        return " and ".join(filter(None, both))

    @property
    def unsaved_session(self) -> str:
        """What would be lost of the session."""
        return "" if self._is_of_other else self._session.unsaved

    def save_other(self, then: Task) -> Message:
        """Save what is not the session's, and go on."""
        return then() if self.other is None else self.other.save(then)

    def before(self, verb: str, task: Task, *, is_of_other: bool = False) -> Message:
        """Go on with `task` at once, or when what is unsaved was saved or given up.

        is_of_other: the session's work is not in danger.
        """
        self._is_of_other = is_of_other
        if not self.unsaved:
            return task()
        self.task, self.verb = task, verb
        return None
