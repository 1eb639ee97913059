"""Surfaces on which pictures are drawn: offscreen frames and windows, with one interface.

    surface.begin();  ...draw...;  [surface.resolve(); ...draw a panel on top...;]  surface.end()

Each surface has a target into which the scene is drawn (`render_target.py`). A window then copies
the target below its panels (`compositor.py`). So `read` also works while a window is hidden or
covered, and returns panels that were drawn after `resolve`.
"""

import contextlib
import os
import sys
from typing import Any, ClassVar, Self

import moderngl
import numpy as np
import numpy.typing as npt

from .errors import OFFSCREEN_TITLE, GLError, diagnose
from .render_target import NewTexture, RenderTarget

Image = npt.NDArray[np.uint8]
NEWEST_VERSION = 430  # OpenGL, times 100: it has compute shaders
OLDEST_VERSION = 330  # OpenGL, times 100: all drawing needs it


class Surface:
    """The interface of both kinds, which `open_offscreen` and `open_window` make.

    - gl: the OpenGL context; objects without references are released when a frame begins.
    - samples: number of samples per pixel that smooth edges; 0: edges are not smoothed.
    - target: the target into which the renderer draws.
    - pixel_scale: pixels per unit of line width: 1, or 2 on a dense screen.
    - scale: pixels of the target per pixel of the surface; a window may set less than 1.
    """

    _current: ClassVar["Surface | None"] = None

    def __init__(
        self,
        gl: moderngl.Context,
        size: tuple[int, int],
        samples: int,
        new_texture: NewTexture | None = None,
    ) -> None:
        """new_texture: as in `RenderTarget`."""
        self.gl = gl
        gl.gc_mode = "context_gc"
        self.pixel_scale = self.scale = 1.0
        self.samples = possible_samples(gl, samples)
        self.target = RenderTarget(gl, size, self.samples, new_texture)
        self._is_open = True

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the frame [pixels]."""
        return self.target.size

    @property
    def is_software(self) -> bool:
        """Whether OpenGL draws on the processor."""
        return is_software(self.gl.info["GL_RENDERER"])

    def begin(self) -> None:
        """Start a frame: clear it, and reset OpenGL state that a GUI may have changed."""
        self.make_current()
        gl = self.gl
        self._collect()
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.depth_func = "<="
        gl.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        gl.wireframe = False
        self.target.start()

    def _collect(self) -> None:
        """Release OpenGL objects without references, while the context is current."""
        while self.gl.objects:
            lost = self.gl.objects.popleft()
            if not isinstance(lost, moderngl.InvalidObject):  # already released
                lost.release()

    def resolve(self) -> None:
        """End the scene; later drawings, such as panels, lie on top with unsmoothed edges."""
        self.make_current()
        self.target.use_frame()

    def end(self) -> None:
        """Finish the frame; a window then shows it."""
        self.resolve()

    def read(self) -> Image:
        """Return the visible frame as a new array, top row first, (H, W, 3), uint8."""
        return self.read_scene()

    def read_scene(self, components: int = 3) -> Image:
        """Return the scene without panels at the target's resolution, (H, W, components), uint8.

        components: 3, or 4 for an alpha channel with premultiplied colours. Alpha is below 255
        where the style has no background.
        """
        self.make_current()
        return image_of(self.target.read(components), self.target.size, components)

    def make_current(self) -> None:
        """Direct OpenGL calls of this thread to this surface, if several are open."""
        if not self._is_open:
            raise GLError("this surface is closed. Cure: open a new one")
        if Surface._current is not self:
            Surface.leave_current()
            Surface._current = self
            self._bind()

    @staticmethod
    def leave_current() -> None:
        """Let no surface receive OpenGL calls of this thread."""
        if Surface._current is not None:
            Surface._current._unbind()
        Surface._current = None

    def close(self) -> None:
        """Release all resources; a second call does nothing."""
        if not self._is_open:
            return
        self.make_current()
        self._close_context()
        self._is_open = False
        Surface._current = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _bind(self) -> None:
        raise NotImplementedError

    def _unbind(self) -> None:
        raise NotImplementedError

    def _close_context(self) -> None:
        raise NotImplementedError


class OffscreenSurface(Surface):
    """A frame without a window, which needs no screen.

    A new frame takes over the context of a closed frame, because moderngl never frees 50 kB of each
    context, and a driver takes milliseconds to make one.
    """

    _is_reusable = True  # whether another frame may take over the context
    _spare: ClassVar[tuple[moderngl.Context, dict[str, str]] | None] = None
    """An unused context, and the environment that chose its device."""

    def _bind(self) -> None:
        self.gl.__enter__()  # type: ignore[no-untyped-call]

    def _unbind(self) -> None:
        self.gl.__exit__(None, None, None)  # type: ignore[no-untyped-call]

    def __exit__(self, *error: object) -> None:
        if error[0] is not None:  # the state of the context is unknown
            self._is_reusable = False
        self.close()

    def _close_context(self) -> None:
        self.target.release()
        self._collect()
        is_reusable = self._is_reusable and self.gl.error == "GL_NO_ERROR"
        self._unbind()  # a released context would stay current, and block the context of a window
        if is_reusable and OffscreenSurface._spare is None:
            OffscreenSurface._spare = self.gl, _glcontext_variables()
        else:
            self.gl.release()


def open_offscreen(size: tuple[int, int], *, samples: int = 4) -> OffscreenSurface:
    """Open an offscreen frame of `size` pixels.

    samples: greatest number of samples per pixel that smooth edges; 0: edges are not smoothed.

    Raises ValueError for an impossible size, and GLError if OpenGL 3.3 is not available. These
    environment variables of glcontext choose device and libraries: GLCONTEXT_DEVICE_INDEX,
    GLCONTEXT_GLVERSION, GLCONTEXT_LINUX_LIBEGL, GLCONTEXT_LINUX_LIBGL.
    """
    check_size(size)
    Surface.leave_current()
    gl = _offscreen_context()
    try:
        surface = OffscreenSurface(gl, size, samples)
    except Exception as error:
        gl.__exit__(None, None, None)  # type: ignore[no-untyped-call]
        gl.release()
        if isinstance(error, moderngl.Error):
            raise GLError(
                f"a frame of {size[0]} x {size[1]} pixels with {samples} samples each cannot be "
                f"made ({error}). Cure: ask for a smaller frame, or for fewer samples"
            ) from None
        raise
    Surface._current = surface
    return surface


def _glcontext_variables() -> dict[str, str]:
    """Return the environment variables by which glcontext chooses device and libraries."""
    return {name: value for name, value in os.environ.items() if name.startswith("GLCONTEXT_")}


def _offscreen_context() -> moderngl.Context:
    """Return the context of a closed frame, or a new context, and make it current."""
    spare = OffscreenSurface._spare
    if spare is not None and spare[1] == _glcontext_variables():
        OffscreenSurface._spare = None
        spare[0].__enter__()  # type: ignore[no-untyped-call]
        return spare[0]
    return _new_context()


def _new_context() -> moderngl.Context:
    """Make a context of OpenGL 4.3, or else of 3.3, by EGL on Linux.

    Both are tried, because some drivers give exactly the requested version.
    """
    is_linux = sys.platform.startswith("linux")
    how: dict[str, Any] = {"standalone": True, **({"backend": "egl"} if is_linux else {})}
    with contextlib.suppress(Exception):  # glcontext raises no class of its own
        return moderngl.create_context(require=NEWEST_VERSION, **how)
    try:
        return moderngl.create_context(require=OLDEST_VERSION, **how)
    except Exception as error:
        raise diagnose(f"{OFFSCREEN_TITLE} (EGL)" if is_linux else OFFSCREEN_TITLE, error) from None


def image_of(pixels: bytes, size: tuple[int, int], components: int = 3) -> Image:
    """Convert bytes of OpenGL, bottom row first, to an image, top row first.

    size: width and height [pixels]. Returns (H, W, components), uint8.
    """
    width, height = size
    return np.frombuffer(pixels, np.uint8).reshape(height, width, components)[::-1].copy()


def check_size(size: tuple[int, int]) -> None:
    """Raise ValueError unless `size` is a width and a height of at least one pixel."""
    if len(size) != 2 or min(size) < 1:
        raise ValueError(f"size is {size}; it must be (width, height), each 1 pixel or more")


def possible_samples(gl: moderngl.Context, samples: int) -> int:
    """Return the greatest power of two up to `samples` that the driver supports, else 0."""
    if samples < 0:
        raise ValueError(f"samples is {samples}; it must be 0 (none) or a number such as 4")
    # The limits of colour textures and of all other attachments may differ.
    allowed = min(samples, gl.max_samples, int(gl.info["GL_MAX_COLOR_TEXTURE_SAMPLES"]))
    return 0 if allowed < 2 else 1 << (allowed.bit_length() - 1)


def is_software(renderer: str) -> bool:
    """Whether an OpenGL renderer of this name draws on the CPU."""
    return any(name in renderer.lower() for name in ("llvmpipe", "softpipe", "swrast", "swr"))
