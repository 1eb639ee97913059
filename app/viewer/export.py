"""Pictures and films of what is displayed, written as `risorius capture` writes them."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

from ..capture import outputs
from ..capture.outputs import FrameSink
from ..errors import UserError
from ..files import Image, save_png
from .messages import Message, Messages
from .stage import Stage
from .view import View

FRAMES_PER_SECOND = 30.0


def free_name(folder: Path, suffix: str) -> Path:
    """A name by date and time that no file has yet."""
    stem = time.strftime("risorius-%Y%m%d-%H%M%S")
    names = (f"{stem}{extra}{suffix}" for extra in ("", *(f"-{n}" for n in range(2, 100))))
    return next((folder / name for name in names if not (folder / name).exists()), folder / stem)


class Film:
    """A film that grows by a frame at a time; the file is there once it is closed."""

    def __init__(self, target: Path) -> None:
        self.target = target
        self.frame_count = 0
        self._size: tuple[int, int] | None = None
        self._files = contextlib.ExitStack()
        self._sink: FrameSink | None = None

    @property
    def seconds(self) -> float:
        """How long it is so far."""
        return self.frame_count / FRAMES_PER_SECOND

    def add(self, frame: Image) -> None:
        """Add a frame; UserError where the size has changed."""
        size = frame.shape[1], frame.shape[0]
        if self._sink is None:
            self._size = size
            opened = outputs.film(self.target, size, FRAMES_PER_SECOND)
            self._sink = self._files.enter_context(opened)
        if self._size != size:
            raise UserError("the film ends here, because the picture has another size now")
        self._sink(frame)
        self.frame_count += 1

    def close(self) -> None:
        """Finish the file."""
        self._files.close()
        self._sink = None


class Exporter:
    """Screenshots and films of a stage, into the present folder."""

    def __init__(self, stage: Stage, view: View) -> None:
        self._stage, self._view = stage, view
        self.film: Film | None = None  # that is being made

    def screenshot(self) -> Message:
        """Write the picture without panels, in full detail."""
        target = free_name(Path.cwd(), ".png")
        save_png(target, self._stage.draw_image(self._view))
        return f"{target.name}: written to {target.parent}"

    def toggle_film(self) -> Message:
        """Begin a film of what is displayed, or finish it."""
        if self.film is None:
            self.film = Film(free_name(Path.cwd(), ".mp4"))
            return None
        film, self.film = self.film, None
        film.close()
        if not film.frame_count:
            return None
        return f"{film.target.name}: {film.seconds:.1f} s in {film.target.parent}"

    def add_to_film(self, messages: Messages) -> None:
        """Draw the next frame of the film, which ends where that cannot be written."""
        film, frame = self.film, self._stage.draw_image(self._view)
        if film is not None:
            messages.attempt(lambda: film.add(frame), otherwise=self.toggle_film)

    def close(self) -> None:
        """Finish a film that is being made."""
        if self.film is not None:
            self.film.close()
