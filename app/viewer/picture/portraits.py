"""Small pictures of persons for a list; a process of low priority draws each picture once.

Until a picture arrives, the window shows only a name. The user's cache stores the pictures until
the program changes.
"""

from __future__ import annotations

import contextlib
import hashlib
import shutil
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import moderngl
import numpy as np
import PIL.Image
from imgui_bundle import imgui

import risorius
from risorius import app, assets, refine, render, sim
from risorius.folders import cache_folder

from ...capture import Capture, CaptureOptions
from ...errors import UserError
from ...pictures import Image, save_png
from ...scenes import BUILT_IN, build_face, called_head
from ...workers import Send, WorkerPool, lower_priority, share_of_cores

PORTRAIT_SIDE = 128  # side of a square picture [pixels]


class Portraits:
    """The pictures of persons in one window."""

    def __init__(self, gl: moderngl.Context, wake: Callable[[], None]) -> None:
        """gl: the window's context. wake: a thread calls this function when a picture arrives."""
        self._gl = gl
        self._wake = wake
        self._pool = WorkerPool(share_of_cores())
        self._is_begun = False
        self._waiting: deque[tuple[int | str, Image]] = deque()
        self._textures: dict[int | str, moderngl.Texture] = {}

    def begin(self, people: Sequence[int | str]) -> None:
        """Begin to read or draw pictures of these persons in this order, unless begun already."""
        if self._is_begun:
            return
        self._is_begun = True
        thread = ThreadPoolExecutor(1)
        thread.submit(self._find, people)
        thread.shutdown(wait=False)

    def _find(self, people: Sequence[int | str]) -> None:
        """Take stored pictures, and let a process draw the others; runs in a thread."""
        missing = []
        for who in people:
            image = kept_portrait(who)
            if image is None:
                missing.append(who)
            else:
                self._take((who, image))
        if not missing:
            return
        # The process may fail, because the list also works with names only.
        self._pool.run(draw_portraits, missing, on_message=self._take, attempts=1)

    def _take(self, drawn: tuple[int | str, Image]) -> None:
        """Keep a picture until the window's own thread makes a texture of it."""
        self._waiting.append(drawn)
        self._wake()

    @property
    def has_news(self) -> bool:
        """Whether a picture has arrived."""
        return bool(self._waiting)

    def take_in(self) -> None:
        """Make textures of new pictures; the window's thread calls this once a frame."""
        while self._waiting:
            name, image = self._waiting.popleft()
            texture = self._gl.texture(
                (PORTRAIT_SIDE, PORTRAIT_SIDE), 3, image.tobytes(), alignment=1
            )
            texture.build_mipmaps()
            texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
            self._textures[name] = texture

    def picture_of(self, who: int | str) -> imgui.ImTextureRef | None:
        """Return the picture of a person; None if it is not drawn yet."""
        drawn = self._textures.get(who)
        return None if drawn is None else imgui.ImTextureRef(drawn.glo)

    def close(self) -> None:
        """Stop drawing."""
        self._pool.stop()


def draw_portraits(people: Sequence[int | str], send: Send) -> None:
    """Draw each person at rest, store the picture and send it; runs in a process."""
    lower_priority(10)  # so that the window stays fast
    _remove_stale()
    for who in people:
        scene = build_face(None if who == BUILT_IN else called_head(who))
        with Capture(scene, CaptureOptions((PORTRAIT_SIDE, PORTRAIT_SIDE))) as capture:
            image = capture.draw_image()
        with contextlib.suppress(UserError):  # an unsaved picture is drawn again next time
            save_png(_file_of(who), image)
        send((who, image))


def kept_portrait(who: int | str) -> Image | None:
    """Return the stored picture of a person, a square of PORTRAIT_SIDE; None if there is none."""
    try:
        with PIL.Image.open(_file_of(who)) as picture:
            image = np.asarray(picture.convert("RGB"))
    except (OSError, SyntaxError, ValueError):  # missing, or incomplete
        return None
    return image if image.shape == (PORTRAIT_SIDE, PORTRAIT_SIDE, 3) else None


def _file_of(who: int | str) -> Path:
    return cache_folder() / f"portraits-{_program()}" / f"{who}.png"


@cache
def _program() -> str:
    """Return a digest of the program's files, because a changed file may change the pictures."""
    digest = hashlib.sha256(risorius.__version__.encode())
    for package in (risorius, app, assets, refine, render, sim):
        for folder in map(Path, package.__path__):
            for file in sorted(folder.rglob("[!.]*.*")):
                if file.suffix == ".pyc":  # Python makes these
                    continue
                status = file.stat()
                name = file.relative_to(folder)
                digest.update(f"{name} {status.st_size} {status.st_mtime_ns}".encode())
    return digest.hexdigest()[:16]


def _remove_stale() -> None:
    """Remove pictures from another state of the program."""
    present = _file_of(BUILT_IN).parent
    for folder in present.parent.glob("portraits-*"):
        if folder != present:
            shutil.rmtree(folder, ignore_errors=True)
