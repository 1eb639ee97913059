"""GLFW windows, whose frames are drawn like offscreen frames and then shown.

glfw is imported only when a window is opened, because a GUI library with its own GLFW must be
imported before glfw, and a server without a screen does not need glfw.
"""

import contextlib
from collections.abc import Iterator, Sequence
from functools import partial
from types import ModuleType
from typing import Any

import moderngl
import numpy as np

from .byte_order import window_textures
from .compositor import Compositor, Detail
from .errors import GLError, diagnose
from .render_target import NewTexture, Rectangle, RenderTarget, clamped_texture
from .style import Colour
from .surface import (
    NEWEST_VERSION,
    OLDEST_VERSION,
    Image,
    Surface,
    check_size,
    image_of,
    is_software,
    possible_samples,
)


class WindowSurface(Surface):
    """A surface in a window; `detail`, `area`, `rules` and `labels` may be set for the next frames.

    - handle: the GLFW window, for input and GUI libraries.
    - frame_size: width and height [pixels] that a frame would have if it began now, as of the last
      events; a minimised window counts as one pixel.
    - detail: resolution of the scene.
    - area: the rectangle that shows the scene [pixels], if panels hide the rest; None: all.
    - rules: rectangles [pixels] in one colour over the scene, such as a line between two halves.
    - labels: pictures over the scene and the rules, such as captions. Each has x and y of its lower
      left corner [pixels], and premultiplied RGBA, top row first, (h, w, 4), uint8.
    """

    def __init__(self, glfw: ModuleType, handle: Any, gl: moderngl.Context, samples: int) -> None:
        self._glfw = glfw
        self.handle = handle
        # Each question for the size waits for the answer of the X server.
        glfw.set_framebuffer_size_callback(handle, self._note_size)
        self._note_size(handle, *glfw.get_framebuffer_size(handle))
        self._new_texture: NewTexture = partial(clamped_texture, gl)
        if is_software(gl.info["GL_RENDERER"]):
            self._new_texture = window_textures(gl, glfw.get_proc_address)
        size = self.frame_size
        super().__init__(gl, size, samples, self._new_texture)
        self.detail = Detail(self.samples)
        self.area: Rectangle | None = None
        self.rules: Sequence[tuple[Rectangle, Colour]] = ()
        self.labels: Sequence[tuple[int, int, Image]] = ()
        self._compositor = Compositor(gl, size, self._new_texture)
        self._is_resolved = False  # whether `resolve` was called in this frame
        self._is_laid = False  # whether the compositor has the current scene
        self.pixel_scale = max(glfw.get_window_content_scale(handle))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the window's frame [pixels]; viewports are given in these pixels."""
        return self._compositor.size

    def _note_size(self, _: Any, width: int, height: int) -> None:
        """Note a new size of the frame."""
        self.frame_size = max(int(width), 1), max(int(height), 1)

    @property
    def should_close(self) -> bool:
        """Whether the user asked to close the window; settable."""
        return bool(self._glfw.window_should_close(self.handle))

    @should_close.setter
    def should_close(self, value: bool) -> None:
        self._glfw.set_window_should_close(self.handle, value)

    def begin(self) -> None:
        """Start a frame in the window's current size, with the resolution of `detail`."""
        self.make_current()
        size = self.frame_size
        if size != self.size:
            self._compositor = Compositor(self.gl, size, self._new_texture)
            self.pixel_scale = max(self._glfw.get_window_content_scale(self.handle))
        self.samples = possible_samples(self.gl, self.detail.samples)
        self.scale = self.detail.scale
        scaled = self.detail.scaled(size)
        if (scaled, self.samples) != (self.target.size, self.target.samples):
            self.target = RenderTarget(self.gl, scaled, self.samples, self._new_texture)
        self._is_resolved = False
        super().begin()

    def resolve(self) -> None:
        """End the scene; later drawings are panels on top. A second call removes the panels."""
        self.make_current()
        self._compose()
        self._is_resolved = self._is_laid = True

    def fill(self, area: Rectangle, colour: Colour) -> None:
        """Paint a rectangle of the resolved frame in one colour, faster than a quad would."""
        self._compositor.frame.clear(*colour, viewport=area)

    def end(self) -> None:
        """Finish the frame and show it; without a call of `resolve`, the last panels stay.

        So unchanged panels need not be drawn again, and the scene is copied only once.
        """
        self.make_current()
        if self._is_resolved:
            self._compositor.copy_to(self.gl.screen)
        else:
            self._compositor.compose(self.target, self.area, self.gl.screen)
            self._draw_marks(self.gl.screen)
            if self.area is not None:
                self._compositor.copy_to(self.gl.screen, around=self.area)
            self._is_laid = False
        self._glfw.swap_buffers(self.handle)
        self._is_resolved = False

    def _compose(self) -> None:
        """Draw the scene and marks into the compositor's frame."""
        self._compositor.compose(self.target, self.area)
        self._draw_marks(self._compositor.frame)

    def _draw_marks(self, target: moderngl.Framebuffer) -> None:
        for rectangle, colour in self.rules:
            target.clear(*colour, viewport=rectangle)
        for label in self.labels:
            self._compositor.draw_label(*label)

    def show(self, image: Image) -> None:
        """Show an image of the frame's size instead of a frame, (H, W, 3), uint8."""
        self.make_current()
        self.gl.screen.use()
        self.gl.scissor = None
        self._compositor.draw_label(
            0, 0, np.dstack([image, np.full(image.shape[:2], 255, np.uint8)])
        )
        self._glfw.swap_buffers(self.handle)

    def read(self) -> Image:
        """Return the visible frame with panels, top row first, (H, W, 3), uint8."""
        self.make_current()
        if not self._is_laid:
            self._compose()
        return image_of(self._compositor.read(), self.size)

    def _bind(self) -> None:
        self._glfw.make_context_current(self.handle)

    def _unbind(self) -> None:
        self._glfw.make_context_current(None)

    def _close_context(self) -> None:
        self.gl.release()
        self._glfw.destroy_window(self.handle)


class _Loader:
    """Gives moderngl the OpenGL functions of a context of GLFW, on any platform."""

    def __init__(self, glfw: ModuleType) -> None:
        self._glfw = glfw

    def load_opengl_function(self, name: str) -> int:
        return self._glfw.get_proc_address(name) or 0

    load = load_opengl_function

    def release(self) -> None:
        """Do nothing: the window owns the context, not moderngl."""

    def __enter__(self) -> "_Loader":
        return self

    def __exit__(self, *_: object) -> None:
        pass


def open_window(
    size: tuple[int, int],
    title: str,
    *,
    samples: int = 4,
    visible: bool = True,
    is_scaled: bool = False,
) -> WindowSurface:
    """Open a window of `size` screen units, or a smaller window if the screen is smaller.

    Its frame may have more pixels than screen units. If you use imgui_bundle, import it first: glfw
    must come from the GUI library.

    - samples: as in `open_offscreen`.
    - is_scaled: whether to enlarge the window on dense screens whose unit is a pixel.

    Raises ValueError for an impossible size, and GLError if there is no screen or no OpenGL 3.3.
    """
    check_size(size)
    glfw = _import_glfw()
    Surface.leave_current()
    with _collected_errors(glfw) as complaints:
        if not glfw.init():
            raise diagnose("opening a window", "; ".join(complaints))
        for version in (NEWEST_VERSION, OLDEST_VERSION):
            complaints.clear()
            _set_window_hints(glfw, is_scaled, version)
            if handle := glfw.create_window(*size, title, None, None):
                break
        else:
            raise diagnose("opening a window", "; ".join(complaints))
        if visible:
            _fit_into_screen(glfw, handle)
            glfw.show_window(handle)
    glfw.make_context_current(handle)
    glfw.swap_interval(1 if visible else 0)
    try:
        loader: dict[str, Any] = {"context": _Loader(glfw)}
        gl = moderngl.create_context(require=OLDEST_VERSION, **loader)
        surface = WindowSurface(glfw, handle, gl, samples)
    except Exception as error:
        glfw.destroy_window(handle)
        if isinstance(error, (GLError, ValueError)):
            raise
        raise diagnose("OpenGL in the window", error) from None
    Surface._current = surface
    return surface


def _fit_into_screen(glfw: ModuleType, handle: Any) -> None:
    """Shrink a window so that it fits, with its decorations, into the work area of the screen."""
    if not (monitor := glfw.get_primary_monitor()):
        return
    left, top, right, bottom = glfw.get_window_frame_size(handle)
    _, _, wide, high = glfw.get_monitor_workarea(monitor)
    width, height = glfw.get_window_size(handle)
    room = max(wide - left - right, 1), max(high - top - bottom, 1)
    if width > room[0] or height > room[1]:
        glfw.set_window_size(handle, min(width, room[0]), min(height, room[1]))


def _set_window_hints(glfw: ModuleType, is_scaled: bool, version: int) -> None:
    glfw.default_window_hints()
    glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, version // 100)
    glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, version // 10 % 10)
    glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
    glfw.window_hint(glfw.OPENGL_FORWARD_COMPAT, True)  # macOS refuses 3.3 core without it
    glfw.window_hint(glfw.VISIBLE, False)
    glfw.window_hint(glfw.SCALE_TO_MONITOR, is_scaled)
    # Edges are smoothed in the target, so the window needs neither samples nor depths.
    glfw.window_hint(glfw.SAMPLES, 0)
    glfw.window_hint(glfw.DEPTH_BITS, 0)
    glfw.window_hint(glfw.STENCIL_BITS, 0)


def _import_glfw() -> ModuleType:
    try:
        import glfw
    except Exception as error:
        raise diagnose("loading GLFW", error) from None
    return glfw


@contextlib.contextmanager
def _collected_errors(glfw: ModuleType) -> Iterator[list[str]]:
    """Collect error reports of GLFW, which would otherwise become Python warnings."""
    texts: list[str] = []

    def note(code: int, text: bytes | str) -> None:
        """Collect one report of GLFW."""
        texts.append(text.decode(errors="replace") if isinstance(text, bytes) else text)

    previous = glfw.set_error_callback(note)
    try:
        yield texts
    finally:
        glfw.set_error_callback(previous)
