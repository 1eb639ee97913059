"""Small pictures of persons, to choose from: a process of low priority draws them, once a window.

The window goes on meanwhile, and shows names until a picture comes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import moderngl
from imgui_bundle import imgui

from ...capture import Capture, CaptureOptions
from ...pictures import Image
from ...scenes import BUILT_IN, build_face, called_head
from ...workers import Send, WorkerPool, give_way, share_of_cores

SIDE = 128  # of a picture [pixels]


class Portraits:
    """The pictures of a window."""

    def __init__(self, gl: moderngl.Context, wake: Callable[[], None]) -> None:
        """gl: of the window. wake: called from a thread when a picture has come."""
        self._gl = gl
        self._wake = wake
        self._pool = WorkerPool(share_of_cores())
        self._is_begun = False
        self._waiting: deque[tuple[int | str, Image]] = deque()
        self._textures: dict[int | str, moderngl.Texture] = {}

    def begin(self, people: Sequence[int | str]) -> None:
        """Have these persons drawn, in this order, if nobody has begun that yet."""
        if self._is_begun:
            return
        self._is_begun = True
        thread = ThreadPoolExecutor(1)
        # Without pictures there still are names: how the process ends matters to nobody.
        thread.submit(self._pool.run, draw_portraits, people, on_message=self._take, attempts=1)
        thread.shutdown(wait=False)

    def _take(self, drawn: tuple[int | str, Image]) -> None:
        """Keep a picture until the window's own thread makes a texture of it."""
        self._waiting.append(drawn)
        self._wake()

    @property
    def has_news(self) -> bool:
        """Whether a picture has come."""
        return bool(self._waiting)

    def take_in(self) -> None:
        """Make textures of the pictures that have come; in the window's thread, once a frame."""
        while self._waiting:
            name, image = self._waiting.popleft()
            texture = self._gl.texture((SIDE, SIDE), 3, image.tobytes(), alignment=1)
            texture.build_mipmaps()
            texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
            self._textures[name] = texture

    def of(self, who: int | str) -> imgui.ImTextureRef | None:
        """The picture of a person, None where it is not drawn yet."""
        drawn = self._textures.get(who)
        return None if drawn is None else imgui.ImTextureRef(drawn.glo)

    def close(self) -> None:
        """Draw no more."""
        self._pool.stop()


def draw_portraits(people: Sequence[int | str], send: Send) -> None:
    """In a process: draw each person at rest, and send the name or number with the picture."""
    give_way(10)  # for the window to go on as fast
    for who in people:
        scene = build_face(None if who == BUILT_IN else called_head(who))
        with Capture(scene, CaptureOptions((SIDE, SIDE))) as capture:
            send((who, capture.draw_image()))
