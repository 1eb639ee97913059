"""The question before work is lost; what it looks like is in panels/question_box.py."""

from __future__ import annotations

from .messages import Message, Task
from .session import Session


class Question:
    """Asks before unsaved work is lost: save it, lose it, or go back."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.task: Task | None = None  # what waits for the answer
        self.verb = ""  # for it, as "Close"

    @property
    def is_open(self) -> bool:
        """Whether an answer is awaited."""
        return self.task is not None

    def before(self, verb: str, task: Task) -> Message:
        """Go on with `task` at once, or when what is unsaved was saved or given up."""
        if not self._session.unsaved:
            return task()
        self.task, self.verb = task, verb
        return None
