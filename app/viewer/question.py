"""The question before work is lost; what it looks like is in panels/question_box.py."""

from __future__ import annotations

from typing import Protocol

from .messages import Message, Task
from .session import Session


class Unsaved(Protocol):
    """Work that is not the session's."""

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
        self.other: Unsaved | None = None  # whose work is in danger, in place of the session's

    @property
    def is_open(self) -> bool:
        """Whether an answer is awaited."""
        return self.task is not None

    @property
    def unsaved(self) -> str:
        """What would be lost, in words; "" for nothing."""
        return (self.other or self._session).unsaved

    def before(self, verb: str, task: Task, other: Unsaved | None = None) -> Message:
        """Go on with `task` at once, or when what is unsaved was saved or given up."""
        self.other = other
        if not self.unsaved:
            return task()
        self.task, self.verb = task, verb
        return None
