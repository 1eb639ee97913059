"""Small pictures of persons, to choose from: a process of low priority draws them, once.

The window goes on meanwhile, and shows names until a picture comes. The user's cache keeps pictures
for the present state of the program.
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
from ...workers import Send, WorkerPool, give_way, share_of_cores

SIDE = 128  # of a square picture [pixels]


class Portraits:
    """The pictures of a window."""

    def __init__(self, gl: moderngl.Context, wake: Callable[[], None]) -> None:
        """gl: the window's context. wake: a thread calls it when a picture has come."""
        self._gl = gl
        self._wake = wake
        self._pool = WorkerPool(share_of_cores())
        self._is_begun = False
        self._waiting: deque[tuple[int | str, Image]] = deque()
        self._textures: dict[int | str, moderngl.Texture] = {}

    def begin(self, people: Sequence[int | str]) -> None:
        """Begin to read or draw pictures of these persons in this order, unless this has begun."""
        if self._is_begun:
            return
        self._is_begun = True
        thread = ThreadPoolExecutor(1)
        thread.submit(self._find, people)
        thread.shutdown(wait=False)

    def _find(self, people: Sequence[int | str]) -> None:
        """In a thread: take stored pictures, and let a process draw the others."""
        missing = []
        for who in people:
            image = kept_portrait(who)
            if image is None:
                missing.append(who)
            else:
                self._take((who, image))
        if not missing:
            return
        # Names suffice without pictures, so the end of the process does not matter.
        self._pool.run(draw_portraits, missing, on_message=self._take, attempts=1)

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
        """The picture of a person, None if it is not drawn yet."""
        drawn = self._textures.get(who)
        return None if drawn is None else imgui.ImTextureRef(drawn.glo)

    def close(self) -> None:
        """Stop drawing."""
        self._pool.stop()


def draw_portraits(people: Sequence[int | str], send: Send) -> None:
    """In a process: draw each person at rest, keep the picture, and send it with name or number."""
    give_way(10)  # so that the window stays fast
    _remove_stale()
    for who in people:
        scene = build_face(None if who == BUILT_IN else called_head(who))
        with Capture(scene, CaptureOptions((SIDE, SIDE))) as capture:
            image = capture.draw_image()
        with contextlib.suppress(UserError):  # it is drawn again the next time
            save_png(_file_of(who), image)
        send((who, image))


def kept_portrait(who: int | str) -> Image | None:
    """The stored picture of a person, shape (SIDE, SIDE, 3); None if there is none."""
    try:
        with PIL.Image.open(_file_of(who)) as picture:
            image = np.asarray(picture.convert("RGB"))
    except (OSError, SyntaxError, ValueError):  # missing, or incomplete
        return None
    return image if image.shape == (SIDE, SIDE, 3) else None


def _file_of(who: int | str) -> Path:
    return cache_folder() / f"portraits-{_program()}" / f"{who}.png"


@cache
def _program() -> str:
    """A digest of the installed program: if one of its files changes, pictures may, too."""
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
