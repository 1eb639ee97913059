"""Open the window on a screen of twice the density, and print its state for a test.

It is a separate program, because GLFW reads the density once, when it starts.
"""

import contextlib
import json
from collections.abc import Iterator

from Xlib import Xatom, display

from risorius.app.performances import script_for
from risorius.app.viewer import Viewer
from risorius.assets.loading import load

from .driving import click, drag, middle, moved, seen_at, settle, show_controls, until, xdotool

DOTS_PER_INCH = 192
SIZE = (1200, 800)


def main() -> None:
    """Print the state of the window on a dense screen."""
    with _dense_screen(), Viewer(script_for(None, "face"), SIZE) as viewer:
        first = viewer.face.view.viewport[0]
        settle(viewer)
        is_settled = viewer.face.view.viewport[0] == first
        print(json.dumps({**_findings(viewer), "is_settled": is_settled}))


@contextlib.contextmanager
def _dense_screen() -> Iterator[None]:
    """Set the density of the X screen, and remove it afterwards."""
    screen = display.Display()
    root = screen.screen().root
    resources = screen.intern_atom("RESOURCE_MANAGER")
    root.change_property(resources, Xatom.STRING, 8, f"Xft.dpi:\t{DOTS_PER_INCH}\n".encode())
    screen.flush()
    screen.sync()
    try:
        yield
    finally:
        root.delete_property(resources)
        screen.sync()


def _findings(viewer: Viewer) -> dict[str, object]:
    left, top, right, bottom = viewer.gui.places["Neutral"]
    show_controls(viewer, "jaw_open")
    drag(viewer, middle(viewer, "jaw_open"), (40, 0))
    xdotool(viewer, "mouseup", 1)
    slid = viewer.session.values["jaw_open"]
    click(viewer, "Neutral")
    until(viewer, lambda: moved(viewer) < 0.5)
    corner = viewer.session.scene.positions[load("head").landmarks[54]]
    drag(viewer, seen_at(viewer, corner), (50, -40))
    until(viewer, lambda: moved(viewer) > 4.0)
    dragged = moved(viewer)
    xdotool(viewer, "mouseup", 1)
    return {
        "button": (right - left, bottom - top),
        "line": viewer.surface.pixel_scale,
        "frame": viewer.surface.size,
        "window": viewer.gui.window_size,
        "slid": slid,
        "dragged": dragged,
    }


if __name__ == "__main__":
    main()
