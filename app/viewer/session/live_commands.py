"""A live face in the window: its commands, its calibration, and its override of the session.

The live face overrides sliders and script, except for controls that its packets do not have.
"""

from __future__ import annotations

from collections.abc import Callable

from ...errors import UserError
from ...live.live_face import LOST_AFTER, LiveFace, SenderState
from ...live.protocols import Listening, own_address
from ..messages import Message
from .session import Session

PACKET_WAIT = 0.008  # [s] for which a frame waits for a packet: half of a phone's frame


def check_scene(name: str) -> None:
    """Raise UserError for a scene that no live face can move."""
    if name != "face":
        raise UserError(f"a live face moves the scene 'face', not '{name}'")


class LiveCommands:
    """Commands of menus and panels for a live face, and its state for the window.

    wanted: protocol, address and port for `toggle`; settable.
    face: the live face, or None if the window does not listen.
    own_address: the address to which a phone must send, "" without a network.
    """

    def __init__(
        self, session: Session, show_panel: Callable[[], None], wake: Callable[[], None]
    ) -> None:
        """show_panel: shows the panel with the live face's state; called when listening begins.

        wake: wakes a window that waits for events; another thread calls it.
        """
        self._session = session
        self._show_panel = show_panel
        self._wake = wake
        self.wanted = Listening("livelink")
        self.face: LiveFace | None = None
        self.own_address = ""
        self.has_changed = False  # whether the last `advance` changed the sender's state
        self._shown: object = None

    # Commands

    @property
    def is_on(self) -> bool:
        """Whether the window listens to packets."""
        return self.face is not None

    def start(self, wanted: Listening) -> Message:
        """Listen from now on, and show the panel; raises UserError if the port cannot be opened."""
        check_scene(self._session.scene.name)
        self.stop()
        face = LiveFace(wanted, wake=self._wake)
        self.face = face
        self.wanted = wanted
        self.own_address = own_address()
        self._show_panel()
        return f"{wanted.protocol.title}: listening on {wanted.address}, port {face.port}"

    def stop(self) -> None:
        """Stop listening; sliders or script move the face again."""
        if self.face is not None:
            self.face.close()
        self.face = None
        self._session.live_override.override({}, 0.0)

    def toggle(self) -> Message:
        """Start or stop listening."""
        if not self.is_on:
            return self.start(self.wanted)
        self.stop()
        return None

    def calibrate(self) -> Message:
        """Use the face in the next half second as neutral."""
        if self.face is not None:
            self.face.calibrate()
        return "Hold a neutral face, eyes on the camera ..."

    # State for the window

    def advance(self, seconds: float) -> Message:
        """Read new packets, and override the session's controls by the received face."""
        face = self.face
        if face is None:
            self.has_changed = False
            return None
        was_calibrating = face.is_calibrating
        face.advance(min(seconds, 0.1))  # eases by this time [s] at most, even after a longer frame
        shown = face.state, face.received > 0
        self.has_changed = shown != self._shown
        self._shown = shown
        self._session.live_override.override(face.controls(), face.presence)
        if was_calibrating and not face.is_calibrating:
            return "This face is neutral now"
        return None

    @property
    def is_urgent(self) -> bool:
        """Whether the face has just moved."""
        return self.face is not None and self.face.has_news

    @property
    def has_frame(self) -> bool:
        """Whether a packet has arrived that `advance` has not read yet."""
        return self.face is not None and self.face.has_frame

    @property
    def is_busy(self) -> bool:
        """Whether something will soon change without a packet."""
        return self.face is not None and (self.face.is_easing or self.face.is_calibrating)

    @property
    def is_receiving(self) -> bool:
        """Whether a face is visible, and another packet can be expected soon."""
        return self.face is not None and self.face.state is SenderState.RECEIVING

    def due_in(self) -> float:
        """Return how long the window may sleep [s], until the face counts as lost."""
        return LOST_AFTER - self.face.silence if self.face and self.is_receiving else float("inf")
