"""What may lie where the window keeps its settings, and what the environment may say."""

from __future__ import annotations

DEEP = 100_000  # brackets

FILES: dict[str, bytes] = {
    "empty": b"",
    "noise": bytes(range(256)),
    "UTF-16": '{"zoom": 2}'.encode("utf-16"),
    "half": b'{"zoom": 1.',
    "deep lists": b"[" * DEEP + b"]" * DEEP,
    "a long number": b'{"zoom": ' + b"9" * 5000 + b"}",
    "no number": b'{"zoom": NaN, "panel_width": Infinity}',
    "unknown keys": b'{"colour": 1, "display": {"taste": 2}}',
    "display is a list": b'{"display": []}',
    "size NaN": b'{"size": [NaN, NaN]}',
    "theme unknown": b'{"theme": "plaid"}',
    "folds of numbers": b'{"folds": {"a": 7, "b": null, "c": []}}',
    "cameras of NaN": b'{"cameras": {"face": [NaN, NaN, NaN, NaN, NaN, NaN]}}',
    "compare unknown": b'{"display": {"compare": "both"}}',
    "compared with nothing known": b'{"display": {"compare": "wipe", "a": "magic"}}',
    "options unknown": b'{"display": {"options": {"kahler": {"sharpness": 1}}}}',
    "overlays of numbers": b'{"display": {"overlays": [1, null, []]}}',
    "divider NaN": b'{"display": {"divider": NaN}}',
    "switch is a number": b'{"is_linked": 1, "display": {"is_refined": "yes"}}',
}

# What is set (None: taken away), the words of the command, and its exit code.
Row = tuple[dict[str, str | None], str, int]

IMAGE = "capture --scene plane --set amplitude -o x.png --size 16x16 --quiet"
FILM = "capture --scene plane --set amplitude -o x.mp4 --size 16x16 --quiet"

ENVIRONMENTS: dict[str, Row] = {
    "nothing at all": ({"PATH": None, "HOME": None, "LANG": None}, IMAGE, 0),
    "home is nowhere": ({"HOME": "/proc/nowhere", "XDG_CACHE_HOME": None}, IMAGE, 0),
    "cache is a file": ({"XDG_CACHE_HOME": "notes.txt"}, IMAGE, 0),
    "cache is a loop": ({"XDG_CACHE_HOME": "loop", "NUMBA_CACHE_DIR": "loop"}, IMAGE, 0),
    "compiled code nowhere": ({"NUMBA_CACHE_DIR": "/proc/nowhere"}, "controls", 0),
    "no folder for temporary files": ({"TMPDIR": "/nowhere"}, IMAGE, 0),
    "wrong language": ({"LC_ALL": "xx_YY.nothing"}, IMAGE, 0),
    "Python warns of all": ({"PYTHONWARNINGS": "default", "PYTHONDEVMODE": "1"}, "controls", 0),
    "completion": ({"_RISORIUS_COMPLETE": "bash_source"}, "", 0),
    "no film program": ({"IMAGEIO_FFMPEG_EXE": "/nowhere/ffmpeg"}, FILM, 2),
    "film program fails": ({"IMAGEIO_FFMPEG_EXE": "/bin/false"}, FILM, 2),
    "no OpenGL": ({"GLCONTEXT_LINUX_LIBEGL": "nothing.so"}, IMAGE, 2),
    "no screen": ({"DISPLAY": None, "WAYLAND_DISPLAY": None}, "view", 2),
    "wrong screen": ({"DISPLAY": ":987"}, "view", 2),
    "settings in a file": ({"XDG_CONFIG_HOME": "notes.txt", "DISPLAY": None}, "view", 2),
    "compiler is switched off": ({"NUMBA_DISABLE_JIT": "1"}, "doctor --offscreen", 0),
    "older OpenGL": ({"MESA_GL_VERSION_OVERRIDE": "2.1"}, IMAGE, 2),
}
