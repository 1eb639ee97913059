"""Probe the OpenGL of this machine without risk to the caller.

A broken driver may crash the process that loads it. So each attempt runs in a separate Python
process, which writes one JSON object.
"""

import json
import subprocess
import sys
from dataclasses import dataclass

from .errors import GLError

_PROBE_TIMEOUT = 60.0  # [s]; software drivers need a few seconds on a loaded machine


@dataclass(frozen=True)
class Finding:
    """Whether one way to draw works on this machine.

    - name: the way, "offscreen" or "window".
    - message: text of the GLError if it failed, else "".
    - samples: greatest number of samples per pixel.
    - lends_gpu_streams: whether the graphics card that draws meshes can also refine them.
    """

    name: str
    is_ok: bool
    message: str = ""
    vendor: str = ""
    renderer: str = ""
    version: str = ""
    is_software: bool = False
    samples: int = 0
    lends_gpu_streams: bool = False

    def __str__(self) -> str:
        if not self.is_ok:
            return f"{self.name}: no. {self.message}"
        speed = "software, drawn by the CPU" if self.is_software else "hardware"
        return (
            f"{self.name}: yes. {self.renderer} ({speed}), {self.vendor}, OpenGL {self.version}, "
            f"up to {self.samples} samples per pixel"
        )


def probe(*, offscreen_only: bool = False) -> list[Finding]:
    """Return the findings for offscreen frames and for windows; never raises."""
    names = ("offscreen",) if offscreen_only else ("offscreen", "window")
    return [_probe_in_process(name) for name in names]


def _probe_in_process(name: str) -> Finding:
    code = f"from {__package__}.probe import write_finding; write_finding({name!r})"
    try:
        process = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PROBE_TIMEOUT,
            check=True,
        )
    except subprocess.SubprocessError as error:
        status = getattr(error, "returncode", "none")
        message = f"the driver crashed the process that tried it, or hung (exit code {status})"
        return Finding(name, is_ok=False, message=f"{message}. Cure: set LIBGL_ALWAYS_SOFTWARE=1")
    return Finding(name, **json.loads(process.stdout.strip().splitlines()[-1]))


def write_finding(name: str) -> None:
    """Try one way to draw in this process, and write the fields of a `Finding` to stdout."""
    from .surface import NEWEST_VERSION, Surface, open_offscreen
    from .window import open_window

    found: dict[str, object]
    try:
        surface: Surface
        if name == "window":
            surface = open_window((16, 16), "probe", visible=False)
        else:
            surface = open_offscreen((16, 16))
        with surface:
            surface.begin()
            surface.end()
            surface.read()
            found = {
                "is_ok": True,
                "vendor": surface.gl.info["GL_VENDOR"],
                "renderer": surface.gl.info["GL_RENDERER"],
                "version": surface.gl.info["GL_VERSION"],
                "is_software": surface.is_software,
                "samples": surface.gl.max_samples,
                "lends_gpu_streams": surface.gl.version_code >= NEWEST_VERSION,
            }
    except GLError as error:
        found = {"is_ok": False, "message": str(error)}
    except Exception as error:
        found = {"is_ok": False, "message": f"{type(error).__name__}: {error}"}
    sys.stdout.write(json.dumps(found) + "\n")
