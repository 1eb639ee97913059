"""The one error of this package, and the cures for the ways in which OpenGL fails to start.

moderngl and glcontext raise bare `Exception`s with terse texts, GLFW issues Python warnings and
returns NULL. `diagnose` turns such a raw text into one line that a user can act on.
Source of the texts: moderngl 5.13, glcontext 3.1 and GLFW 3.4 / 3.5 on Linux, provoked one by one.
"""

import os
import re

OFFSCREEN = "offscreen OpenGL"
_MESA = "apt install libegl1 libgl1-mesa-dri"
_SOFTWARE = "set LIBGL_ALWAYS_SOFTWARE=1"

# raw text -> (why, cure); the first pattern found wins.
_DIAGNOSES: tuple[tuple[str, str, str], ...] = (
    (r"invalid literal for int", "a GLCONTEXT_ variable is not a whole number", "unset it"),
    (r"found 0 devices", "no OpenGL driver offers itself to EGL", "apt install libgl1-mesa-dri"),
    (r"requested device index", "there is no EGL device of that number", "unset it"),
    (r"libGL\S* not loaded", "the OpenGL library is missing", "apt install libgl1 libgl1-mesa-dri"),
    (r"not loaded", "the EGL library is missing", _MESA),
    (r"egl\w+ not found|gl\w+ not found", "that library is not OpenGL", _MESA),
    (r"eglInitialize failed", "the EGL driver does not start", "apt install libgl1-mesa-dri"),
    (r"eglCreateContext|0x3009", "the driver has no OpenGL of that version", _SOFTWARE),
    (r"Requested OpenGL version", "the driver is older than OpenGL 3.3", _SOFTWARE),
    (
        r"(DISPLAY|display).*(missing|open)|(open|connect).*display|XOpenDisplay|platform",
        "there is no screen to open a window on",
        "run it under `xvfb-run -a`, or render offscreen",
    ),
    (
        r"GLX extension|Failed to load GLX|libGL|No GLXFBConfigs",
        "the X server or this machine has no OpenGL for windows",
        "apt install libgl1 libgl1-mesa-dri",
    ),
    (r"GLXBadFBConfig|version|WGL|NSGL|EGL", "the driver is older than OpenGL 3.3", _SOFTWARE),
    (
        r"GLFW3 shared library",
        "the GLFW library cannot be loaded",
        "pip install --force-reinstall glfw",
    ),
    (r"No module named 'glfw'", "GLFW is not installed", "pip install 'risorius[window]'"),
)


class GLError(RuntimeError):
    """OpenGL is missing, too old or refuses; one line says what, why, the raw text and the cure."""


def diagnose(what: str, raw: object) -> GLError:
    """Return the GLError for a failed attempt: `what` was tried, `raw` is what the library said."""
    text = " ".join(str(raw).split()) or "no reason given"
    set_by_hand = [name for name in os.environ if name.startswith("GLCONTEXT_")]
    unset = f"unset {', '.join(set_by_hand)}" if what.startswith(OFFSCREEN) and set_by_hand else ""
    for pattern, why, cure in _DIAGNOSES:
        if re.search(pattern, text):
            return GLError(f'{what} failed: {why} ("{text}"). Cure: {unset or cure}')
    return GLError(f'{what} failed ("{text}"). Cure: `risorius doctor` shows what there is')
