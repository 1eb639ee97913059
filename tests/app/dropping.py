"""A small file manager that drops files onto a window as a desktop does (XDND).

`python -m tests.app.dropping TITLE X Y FILE...` releases the files at the screen coordinates x, y,
and ends when the window has reported that it took them. Source: "Drag-and-Drop Protocol for the X
Window System", version 5 (freedesktop.org); only the parts of a source that offers file names.
"""

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from Xlib import X, Xatom, display
from Xlib.protocol import event

VERSION = 5
PATIENCE = 40.0  # [s] for a window that is busy drawing


class Source:
    """The window from which files are dragged."""

    def __init__(self, title: str, paths: Sequence[Path]) -> None:
        self._display = display.Display()
        self._root = self._display.screen().root
        self._target = self._find(self._root, title)
        if self._target is None:
            raise SystemExit(f"no window that takes drops has '{title}' in its title")
        self._window = self._root.create_window(0, 0, 1, 1, 0, X.CopyFromParent)
        self._data = "".join(f"{path.resolve().as_uri()}\r\n" for path in paths).encode()

    def drop(self, x: int, y: int) -> None:
        """Enter the window, move to a place, release, and send the names on request."""
        uris = self._atom("text/uri-list")
        self._window.set_selection_owner(self._atom("XdndSelection"), X.CurrentTime)
        self._tell("XdndEnter", VERSION << 24, uris, 0, 0)
        self._tell("XdndPosition", 0, x << 16 | y, X.CurrentTime, self._atom("XdndActionCopy"))
        status = self._wait_for("XdndStatus")
        if not status.data[1][1] & 1:
            raise SystemExit("the window does not want the files")
        self._tell("XdndDrop", 0, X.CurrentTime, 0, 0)
        # GLFW writes the length of the names into the protocol's bit for success.
        if not self._wait_for("XdndFinished").data[1][1]:
            raise SystemExit("the window has not taken the files")

    def _atom(self, name: str) -> int:
        return int(self._display.intern_atom(name))

    def _find(self, window: Any, title: str) -> Any:
        """The window below a parent that accepts drops and has these words in its title."""
        for child in window.query_tree().children:
            is_aware = child.get_full_property(self._atom("XdndAware"), Xatom.ATOM) is not None
            found = child if is_aware and title in (child.get_wm_name() or "") else None
            found = found or self._find(child, title)
            if found is not None:
                return found
        return None

    def _tell(self, name: str, *words: int) -> None:
        message = event.ClientMessage(
            window=self._target, client_type=self._atom(name), data=(32, [self._window.id, *words])
        )
        self._target.send_event(message)
        self._display.flush()

    def _wait_for(self, name: str) -> Any:
        """The window's next message of this name.

        Requests for file names are answered meanwhile.
        """
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            while self._display.pending_events():
                received = self._display.next_event()
                if received.type == X.SelectionRequest:
                    self._hand_over(received)
                elif received.type == X.ClientMessage and received.client_type == self._atom(name):
                    return received
            time.sleep(0.01)
        raise SystemExit(f"no {name} came")

    def _hand_over(self, request: Any) -> None:
        request.requestor.change_property(request.property, request.target, 8, self._data)
        request.requestor.send_event(
            event.SelectionNotify(
                time=request.time,
                requestor=request.requestor,
                selection=request.selection,
                target=request.target,
                property=request.property,
            )
        )
        self._display.flush()


if __name__ == "__main__":
    window_title, across, down, *files = sys.argv[1:]
    Source(window_title, [Path(name) for name in files]).drop(int(across), int(down))
