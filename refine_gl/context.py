"""An OpenGL context of this process, in a separate thread, for callers without a context.

A context is current in one thread, and a thread has one current context. So our context has a
separate thread, and a caller's current context stays current, whether from EGL, GLX or a window
library. Passing a call to the thread takes tens of microseconds; frames that are read back take
longer.
"""

import functools
import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import moderngl

Result = TypeVar("Result")
LEAST_VERSION = 430
"""Version of OpenGL, times 100: the first with compute shaders."""


class GpuError(RuntimeError):
    """OpenGL cannot refine: the message reports whether it is missing, too old, or too small."""


class OwnContext:
    """The context, and the thread in which it is current."""

    def __init__(self) -> None:
        """Open it; raises GpuError if OpenGL is missing or too old."""
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="kahler-gl")
        try:
            self.gl: moderngl.Context = self.run(_open)
        except Exception as error:  # glcontext raises no class of its own
            self._thread.shutdown()
            reason = " ".join(str(error).split())
            raise GpuError(f"no OpenGL 4.3 without a window ({reason})") from None

    def run(self, call: Callable[..., Result], *arguments: Any) -> Result:
        """Call a function in the thread of the context, and wait for its result."""
        return self._thread.submit(call, *arguments).result()


def _open() -> moderngl.Context:
    """Open a context: by EGL on Linux, or else by X11; on other systems by their own interface."""
    natively: dict[str, Any] = {"require": LEAST_VERSION, "standalone": True}
    try:
        how: dict[str, Any] = {"backend": "egl"} if sys.platform.startswith("linux") else {}
        gl = moderngl.create_context(**natively, **how)
    except Exception:
        if not os.environ.get("DISPLAY"):
            raise
        gl = moderngl.create_context(**natively)
    gl.gc_mode = "context_gc"
    return gl


@functools.cache
def own_context() -> OwnContext:
    """The context of this process; raises GpuError if there can be none."""
    return OwnContext()


if hasattr(os, "register_at_fork"):  # a forked child has no threads
    os.register_at_fork(after_in_child=own_context.cache_clear)
