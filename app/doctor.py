"""`risorius doctor`: what OpenGL there is on this machine, and the cure for what is missing."""

from __future__ import annotations

import platform

import render

from . import __version__


def examine(*, offscreen_only: bool = False) -> tuple[bool, list[str]]:
    """Return (can Risorius work here?, the lines of the report)."""
    lines = [
        f"Risorius {__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}"
    ]
    healthy = True
    for finding in render.probe(offscreen_only=offscreen_only):
        lines.append(str(finding))
        if finding.is_needed and not finding.is_ok:
            healthy = False
    lines.append(
        "Everything that is needed is there."
        if healthy
        else "Something needed is missing: see above."
    )
    return healthy, lines
