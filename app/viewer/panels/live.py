"""The panel of a live face: its sender, and the use of its shapes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from imgui_bundle import imgui

from ...control_names import sentence
from ...live.live_face import LiveFace, SenderState
from ...live.protocols import ANY_ADDRESS, LOOPBACK_ADDRESS, PROTOCOLS
from ...recordings.calibration import HIGHEST_GAIN
from ...recordings.names import ANGLE_NAMES
from ..context import ApplicationContext
from ..interface.commands import Command, command_button
from ..interface.gui import colour
from ..interface.widgets import LabelledRows, hint, muted

MOST_GAIN = min(3.0, HIGHEST_GAIN)
ADDRESS_OF_CHOICE = {"this computer only": LOOPBACK_ADDRESS, "the whole network": ANY_ADDRESS}
LIVE_HINTS = {
    "Protocol": "of the sender; Live Link Face is an app of an iPhone, "
    "VMC is sent by most programs for avatars",
    "Listen to": "a phone needs the whole network; every computer in it can then move this face, "
    "and do nothing else",
    "Port": "the port to which the sender must send",
    "Gain": "factor on all received shapes",
}


class LivePanel:
    """Draws the panel, and carries out the user's actions in it."""

    def __init__(self, app: ApplicationContext, commands: Mapping[str, Command]) -> None:
        """commands: the window's commands, by their labels."""
        self._gui = app.gui
        self._messages = app.messages
        self._live = app.live
        self._commands = commands
        self._rows = LabelledRows(app.gui, share=0.38, hints=LIVE_HINTS)

    def draw(self) -> None:
        """Draw the panel's content inside its window."""
        gui = self._gui
        live = self._live
        messages = self._messages
        imgui.begin_child("live")
        self._draw_listening()
        label = "Stop listening" if live.is_on else "Listen"
        command_button(gui, messages, self._commands["Listen"], label, name="listen", width=-1.0)
        face = live.face  # the button may have changed it
        imgui.push_text_wrap_pos(0.0)
        is_received = face is not None and face.state is SenderState.RECEIVING
        ink = gui.theme.accent if is_received else gui.theme.text
        imgui.text_colored(colour(ink), sentence(state_in_words(face)))
        gui.remember("live state")
        if face is not None:
            muted(gui, sentence(advice_in_words(face, live.own_address)))
            imgui.pop_text_wrap_pos()
            label = "Hold still ..." if face.is_calibrating else "Calibrate"
            meaning = "the face of the next half second is neutral ([Calibrate])"
            calibrate = self._commands["Calibrate"]
            command_button(gui, messages, calibrate, label, name="calibrate", meaning=meaning)
            self._draw_taken(face)
            self._draw_channels(face)
        else:
            imgui.pop_text_wrap_pos()
        imgui.end_child()

    def _draw_listening(self) -> None:
        """Draw rows for the sender: protocol, computers, port."""
        live = self._live
        rows = self._rows
        wanted = live.wanted
        by_title = {each.title: kind for kind, each in PROTOCOLS.items()}
        imgui.begin_disabled(live.is_on)
        chosen = rows.choose("Protocol", wanted.protocol.title, by_title)
        if chosen is not None:
            wanted = replace(wanted, kind=by_title[chosen], port=None)
        names = {address: name for name, address in ADDRESS_OF_CHOICE.items()}
        here = names.get(wanted.address, wanted.address)
        chosen = rows.choose("Listen to", here, dict.fromkeys((*ADDRESS_OF_CHOICE, here)))
        if chosen is not None:
            wanted = replace(wanted, address=ADDRESS_OF_CHOICE.get(chosen, wanted.address))
        rows.begin("Port")
        is_changed, port = imgui.input_int("##port", wanted.chosen_port, 0)
        self._gui.remember("Port")
        if is_changed:
            wanted = replace(wanted, port=min(max(port, 1), 65535))
        imgui.end_disabled()
        live.wanted = wanted

    def _draw_taken(self, face: LiveFace) -> None:
        """Draw the switch of left and right, and the gain of all shapes."""
        imgui.same_line()
        _, mirror = imgui.checkbox("Mirror##live", face.calibration.mirror)
        self._gui.remember("mirror live")
        hint("left and right change places, as in a mirror")
        before = face.calibration
        gain = self._rows.slider_row(
            "Gain", "live Gain", before.default_gain, (0.0, MOST_GAIN), 1.0
        )
        face.calibration = replace(before, mirror=mirror, default_gain=gain)

    def _draw_channels(self, face: LiveFace) -> None:
        """Draw bars of the received channels after calibration; angles are drawn as numbers."""
        taken = face.calibration.apply(face.channels)
        for name, value in sorted(taken.items()):
            self._rows.begin(name)
            if name in ANGLE_NAMES:
                imgui.text(f"{value:.1f} degrees")
            else:
                imgui.progress_bar(min(max(value, 0.0), 1.0), (-1.0, 0.0), f"{value:.2f}")
            self._gui.remember(f"live {name}")


def state_in_words(face: LiveFace | None) -> str:
    """Describe the state of the sender."""
    if face is None:
        return "not listening"
    who = f" {face.subject}" if face.subject else ""
    if face.state is SenderState.RECEIVING:
        return f"receiving{who}, {face.rate:.0f} frames a second"
    if face.state is SenderState.NO_FACE:
        return f"{who.strip() or 'the sender'} sees no face"
    if face.state is SenderState.LOST:
        return f"lost{who}: packets have stopped"
    if face.received:
        return (
            f"packets arrive at port {face.port}, but no face of {face.listening.protocol.title}: "
            "is the protocol right?"
        )
    return f"waiting on port {face.port}: no packet yet"


def advice_in_words(face: LiveFace, own_address: str) -> str:
    """Return the user's next step while no face is received, or the number of unusable packets."""
    if face.state is not SenderState.WAITING or face.received:
        unusable = f", of no use: {face.unusable}" if face.unusable else ""
        return f"packets: {face.received}{unusable}"
    if face.listening.address == LOOPBACK_ADDRESS:
        trial = "; without one, type: risorius send" * (face.listening.kind == "livelink")
        return f"for a phone, listen to the whole network{trial}"
    if face.listening.address == ANY_ADDRESS and own_address:
        return f"in the app, let it send to {own_address}, port {face.port}"
    return f"in the app, let it send to port {face.port} of this computer"
