"""The surface of drawings: an offscreen frame or a window, behind one interface.

Both kinds draw the scene into their own target (`render_target.py`), which a window then copies
under its panels (`compositor.py`). So `read` works for both, even while a window is hidden or
covered, and its picture includes panels that were drawn after `resolve`.
    surface.begin();  ...draw...;  [surface.resolve(); ...draw a panel on top...;]  surface.end()
"""

import contextlib
import os
import sys
from typing import Any, ClassVar, Self

import moderngl
import numpy as np
import numpy.typing as npt

from .errors import OFFSCREEN, GLError, diagnose
from .render_target import RenderTarget

Image = npt.NDArray[np.uint8]
NEWEST_VERSION = 430  # OpenGL, times 100: it has compute shaders
OLDEST_VERSION = 330  # OpenGL, times 100: all drawing needs it


class Surface:
    """The interface of both kinds; made by `open_offscreen` and `open_window`.

    gl: the OpenGL context; when a frame begins, it gets objects without references back.
    samples: number per pixel for smooth edges, 0 = none. target: the one in which the Renderer
        draws.
    pixel_scale: pixels per unit of line width: 1, or 2 on a dense screen.
    scale: pixels of the target per pixel of the surface; below 1 only in a window that draws less
        finely.
    """

    _current: ClassVar["Surface | None"] = None

    def __init__(self, gl: moderngl.Context, size: tuple[int, int], samples: int) -> None:
        self.gl = gl
        gl.gc_mode = "context_gc"
        self.pixel_scale = self.scale = 1.0
        self.samples = possible_samples(gl, samples)
        self.target = RenderTarget(gl, size, self.samples)
        self._is_open = True

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the frame [pixels]."""
        return self.target.size

    @property
    def is_software(self) -> bool:
        """Whether the CPU does the drawing."""
        return is_software(self.gl.info["GL_RENDERER"])

    def begin(self) -> None:
        """Start a frame: empty it, and undo changes of the OpenGL state by a GUI."""
        self.make_current()
        gl = self.gl
        self._collect()
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.depth_func = "<="
        gl.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        gl.wireframe = False
        self.target.start()

    def _collect(self) -> None:
        """Return objects without references to OpenGL, while its context is current."""
        while self.gl.objects:
            lost = self.gl.objects.popleft()
            if not isinstance(lost, moderngl.InvalidObject):  # already released
                lost.release()

    def resolve(self) -> None:
        """End the scene: later drawings (a panel) lie on top, and their edges are not smoothed."""
        self.make_current()
        self.target.use_frame()

    def end(self) -> None:
        """Finish the frame, which a window then shows."""
        self.resolve()

    def read(self) -> Image:
        """Return the visible frame, top row first, shape (H, W, 3), uint8, a new array."""
        return self.read_scene()

    def read_scene(self, components: int = 3) -> Image:
        """Return the scene without panels, at the resolution of its target, like `read`.

        components: 4 adds an alpha channel, and colours are multiplied by it; it is below 255 where
        the style has no background.
        """
        self.make_current()
        return image_of(self.target.read(components), self.target.size, components)

    def make_current(self) -> None:
        """Direct this thread's OpenGL calls here; only several open surfaces need this."""
        if not self._is_open:
            raise GLError("this surface is closed. Cure: open a new one")
        if Surface._current is self:
            return
        if Surface._current is not None:
            Surface._current._unbind()
        Surface._current = self
        self._bind()

    def close(self) -> None:
        """Release everything; a second call does nothing."""
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
    """A frame without a window; needs no screen.

    The next opened frame takes over the context of a closed one: moderngl never frees 50 kB of each
    context, and a driver takes milliseconds for a new one.
    """

    _is_reusable = True  # whether its context may serve again
    _spare: ClassVar[tuple[moderngl.Context, dict[str, str]] | None] = None
    """An unused context, and the environment that chose its device."""

    def _bind(self) -> None:
        self.gl.__enter__()  # type: ignore[no-untyped-call]

    def _unbind(self) -> None:
        self.gl.__exit__(None, None, None)  # type: ignore[no-untyped-call]

    def __exit__(self, *error: object) -> None:
        if error[0] is not None:  # the state of its context is unknown
            self._is_reusable = False
        self.close()

    def _close_context(self) -> None:
        self.target.release()
        self._collect()
        is_reusable = self._is_reusable and self.gl.error == "GL_NO_ERROR"
        self._unbind()  # a released context would stay current, and block a window's own
        if is_reusable and OffscreenSurface._spare is None:
            OffscreenSurface._spare = self.gl, _environment()
        else:
            self.gl.release()


def open_offscreen(size: tuple[int, int], *, samples: int = 4) -> OffscreenSurface:
    """Open a frame of `size` pixels without a screen; up to `samples` a pixel smooth its edges.

    Raises ValueError for an impossible size, GLError if OpenGL 3.3 is not available. The
    environment variables of glcontext choose device and libraries: GLCONTEXT_DEVICE_INDEX,
    GLCONTEXT_GLVERSION, GLCONTEXT_LINUX_LIBEGL, GLCONTEXT_LINUX_LIBGL.
    """
    check_size(size)
    if Surface._current is not None:
        Surface._current._unbind()
        Surface._current = None
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


def _environment() -> dict[str, str]:
    """The variables by which glcontext chooses device and libraries."""
    return {name: value for name, value in os.environ.items() if name.startswith("GLCONTEXT_")}


def _offscreen_context() -> moderngl.Context:
    """The context of a closed frame, or else a new one; it is then current."""
    spare = OffscreenSurface._spare
    if spare is not None and spare[1] == _environment():
        OffscreenSurface._spare = None
        spare[0].__enter__()  # type: ignore[no-untyped-call]
        return spare[0]
    return _new_context()


def _new_context() -> moderngl.Context:
    """A context of the newest OpenGL that we use, else of the oldest that suffices.

    It uses EGL on Linux, and the native way elsewhere. Some drivers give exactly the requested
    version.
    """
    is_linux = sys.platform.startswith("linux")
    how: dict[str, Any] = {"standalone": True, **({"backend": "egl"} if is_linux else {})}
    with contextlib.suppress(Exception):  # glcontext raises no class of its own
        return moderngl.create_context(require=NEWEST_VERSION, **how)
    try:
        return moderngl.create_context(require=OLDEST_VERSION, **how)
    except Exception as error:
        raise diagnose(f"{OFFSCREEN} (EGL)" if is_linux else OFFSCREEN, error) from None


def image_of(pixels: bytes, size: tuple[int, int], components: int = 3) -> Image:
    """Turn OpenGL's bytes, bottom row first, into an image, top row first, (H, W, 3) uint8."""
    width, height = size
    return np.frombuffer(pixels, np.uint8).reshape(height, width, components)[::-1].copy()


def check_size(size: tuple[int, int]) -> None:
    """Raise ValueError unless `size` is a width and a height of at least one pixel."""
    if len(size) != 2 or min(size) < 1:
        raise ValueError(f"size is {size}; it must be (width, height), each 1 pixel or more")


def possible_samples(gl: moderngl.Context, samples: int) -> int:
    """The largest power of two up to `samples` that the driver has; 0 = no smooth edges."""
    if samples < 0:
        raise ValueError(f"samples is {samples}; it must be 0 (none) or a number such as 4")
    # For both attachments of the layer.
    allowed = min(samples, gl.max_samples, int(gl.info["GL_MAX_COLOR_TEXTURE_SAMPLES"]))
    return 0 if allowed < 2 else 1 << (allowed.bit_length() - 1)


def is_software(renderer: str) -> bool:
    """Whether an OpenGL renderer of this name draws on the CPU."""
    return any(name in renderer.lower() for name in ("llvmpipe", "softpipe", "swrast", "swr"))
