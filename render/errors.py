"""The error class of this package, and remedies for the ways in which OpenGL fails to start.

moderngl and glcontext raise plain `Exception`s with short texts; GLFW issues Python warnings and
returns NULL. `diagnose` turns such a text into one line with a remedy. We provoked each text on
Linux, with moderngl 5.13, glcontext 3.1 and GLFW 3.4 / 3.5.
"""

import os
import re

OFFSCREEN_TITLE = "offscreen OpenGL"

# Triples: pattern of the raw text, reason, remedy; the first matching pattern counts.
_DIAGNOSES: tuple[tuple[str, str, str], ...] = (
    (r"invalid literal", "a GLCONTEXT_ variable is not a whole number", "unset it"),
    (r"glfw'|GLFW3", "GLFW is not installed, or broken", "pip install '.[window]' in the checkout"),
    (
        r"(?i)display|platform",
        "there is no screen to open a window on",
        "run it under `xvfb-run -a`, or render offscreen",
    ),
    (
        r"not loaded|not found|devices|device index|eglInitialize|load GLX|No GLXFBConfigs",
        "there is no OpenGL driver",
        "apt install libegl1 libgl1 libgl1-mesa-dri",
    ),
    (
        r"eglCreateContext|0x3009|version|FBConfig|WGL|NSGL|EGL",
        "the driver is older than OpenGL 3.3",
        "set LIBGL_ALWAYS_SOFTWARE=1",
    ),
)


class GLError(RuntimeError):
    """OpenGL is missing, too old, or failed; the message has attempt, reason and remedy."""


def diagnose(attempt: str, raw: object) -> GLError:
    """Return the GLError for a failed attempt; raw: the library's message."""
    text = " ".join(str(raw).split()) or "no reason given"
    set_by_hand = [name for name in os.environ if name.startswith("GLCONTEXT_")]
    unset = ""
    if attempt.startswith(OFFSCREEN_TITLE) and set_by_hand:
        unset = f"unset {', '.join(set_by_hand)}"
    for pattern, why, cure in _DIAGNOSES:
        if re.search(pattern, text):
            return GLError(f'{attempt} failed: {why} ("{text}"). Cure: {unset or cure}')
    return GLError(f'{attempt} failed ("{text}"). Cure: `risorius doctor` shows what works here')
