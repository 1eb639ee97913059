"""A face that is sent while it moves: who sends, how it is taken, and what comes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from imgui_bundle import imgui

from ...controls.vocabulary import sentence
from ...live import ANYWHERE, LOOPBACK, PROTOCOLS, LiveFace, State
from ...recordings.calibration import ANGLES, BLINK_GAIN, HIGHEST_GAIN
from ..context import ApplicationContext
from ..interface.commands import Command
from ..interface.gui import colour, em
from ..interface.widgets import (
    LabelledRows,
    button,
    button_width,
    heading,
    hint,
    muted,
    stay_in_line,
)
from .rows import rows_of

LABEL_SHARE = 0.38  # of a row
MOST_GAIN = min(3.0, HIGHEST_GAIN)
# Gains that have a slider of their own, beside that of all: label -> channels.
BLINK = ("eyeBlinkLeft", "eyeBlinkRight")
HEAD = ("head_yaw", "head_pitch", "head_roll")
COMPUTERS = {LOOPBACK: "this computer alone", ANYWHERE: "the whole network"}
FULL_ANGLE = 45.0  # [degrees] that fill a bar
LEAST_SEEN = 0.05  # of a bar
HINTS = {
    "Protocol": "what the sender speaks; Live Link Face is an app of an iPhone, "
    "VMC is what most programs for avatars send",
    "Listen to": "a phone needs the whole network; whoever is in it can then move this face, and "
    "do nothing else",
    "Port": "where the sender must send to",
    "Gain": "how strongly shapes are taken",
    "Blink": "phones seldom see eyes that are closed completely",
    "Head": "how far the head turns along",
}


class LivePanel:
    """Draws the panel, and carries out what is done in it."""

    def __init__(self, app: ApplicationContext, record: Command) -> None:
        """record: the command that begins and ends a recording."""
        self._gui, self._settings, self._messages = app.gui, app.settings, app.messages
        self._live, self._record = app.live, record
        self._rows = LabelledRows(app.gui, LABEL_SHARE, HINTS)

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        imgui.begin_child("live", (0.0, 0.0), imgui.ChildFlags_.nav_flattened)
        self._draw_listening()
        face = self._live.face  # which that may have begun or ended
        self._draw_state(face)
        if face is not None:
            self._draw_buttons(face)
            if heading(self._gui, self._settings.folds, "Strength"):
                self._draw_gains(face)
            if heading(self._gui, self._settings.folds, "What comes"):
                self._draw_channels(face)
        imgui.end_child()

    # Who sends

    def _draw_listening(self) -> None:
        live = self._live
        wanted = self._live.wanted
        imgui.begin_disabled(live.is_on)
        title = wanted.protocol.title
        by_title = {each.title: kind for kind, each in PROTOCOLS.items()}
        chosen = self._rows.choose("Protocol", title, tuple(by_title))
        if chosen is not None:
            wanted = replace(wanted, kind=by_title[chosen], port=None)
        here = COMPUTERS.get(wanted.address, wanted.address)
        by_name = {name: address for address, name in COMPUTERS.items()}
        by_name.setdefault(here, wanted.address)
        chosen = self._rows.choose("Listen to", here, tuple(by_name))
        if chosen is not None:
            wanted = replace(wanted, address=by_name[chosen])
        self._rows.begin("Port")
        is_changed, port = imgui.input_int("##port", wanted.chosen_port, 0)
        self._gui.remember("Port")
        if is_changed:
            wanted = replace(wanted, port=min(max(port, 1), 65535))
        imgui.end_disabled()
        imgui.spacing()
        live.wanted = wanted
        label = "Stop listening" if live.is_on else "Listen"
        highlight = colour(self._gui.theme.accent, 0.6) if live.is_on else None
        if button(self._gui, label, name="listen", width=-1.0, highlight=highlight):
            self._messages.attempt(live.toggle)

    def _draw_state(self, face: LiveFace | None) -> None:
        """A line on who sends and one on packets."""
        imgui.push_text_wrap_pos(0.0)
        text = sentence(state_in_words(face))
        if face is not None and face.state is State.RECEIVING:
            imgui.text_colored(colour(self._gui.theme.accent), text)
        else:
            imgui.text_unformatted(text)
        self._gui.remember("live state")
        if face is not None:
            advice = advice_in_words(face, self._live.own_address)
            muted(self._gui, sentence(advice or packets_in_words(face)))
        imgui.pop_text_wrap_pos()
        imgui.spacing()

    # How it is taken

    def _draw_buttons(self, face: LiveFace) -> None:
        live, record = self._live, self._record
        is_recording = record.is_on is not None and record.is_on()
        calibrate = "Hold still ..." if face.is_calibrating else "Calibrate"
        buttons: tuple[tuple[str, str, str, bool, Callable[[], str | None]], ...] = (
            ("calibrate", calibrate, "the face of the next half second is neutral ([Calibrate])",
             live.can_calibrate and not face.is_calibrating, live.calibrate),
            ("record live", "Stop recording" if is_recording else "Record",
             "what moves goes into the script, until it is stopped ([Record])", True, record.run),
        )  # fmt: skip
        for number, (name, label, meaning, is_possible, run) in enumerate(buttons):
            if number:
                stay_in_line(button_width(label))
            imgui.begin_disabled(not is_possible)
            highlight = colour(self._gui.theme.accent, 0.6) if label.startswith("Stop") else None
            if button(self._gui, label, name=name, meaning=meaning, highlight=highlight):
                self._messages.attempt(run)
            imgui.end_disabled()
        stay_in_line(imgui.get_frame_height() + imgui.calc_text_size("  Mirror").x)
        is_clicked, _ = imgui.checkbox("Mirror##live", live.is_mirrored)
        self._gui.remember("mirror live")
        hint("left and right change places, as in a mirror")
        if is_clicked:
            live.toggle_mirror()

    def _draw_gains(self, face: LiveFace) -> None:
        calibration, slide, limits = face.calibration, self._rows.slide, (0.0, MOST_GAIN)
        gain = slide("Gain", "live Gain", calibration.default_gain, limits, 1.0)
        if gain is not None:
            face.calibration = replace(calibration, default_gain=gain)
        for label, names, usual in (("Blink", BLINK, BLINK_GAIN), ("Head", HEAD, 1.0)):
            now = calibration.gains.get(names[0], 1.0)
            gain = slide(label, f"live {label}", now, limits, usual)
            if gain is not None:
                gains = {**calibration.gains, **dict.fromkeys(names, gain)}
                face.calibration = replace(calibration, gains=gains)

    # What comes

    def _draw_channels(self, face: LiveFace) -> None:
        """A row for each channel, or for the two of both sides: a bar and a number."""
        shown = shown_of(face)
        if not shown:
            muted(self._gui, "Nothing yet")
        for row in rows_of(tuple(shown), shown, linked=False):
            names = row.names
            shares = [_share(name, shown[name]) for name in names]
            is_seen = max(shares) >= LEAST_SEEN
            ink = self._gui.theme.accent if is_seen else self._gui.theme.muted
            imgui.text_colored(colour(ink), row.label)
            hint("right | left" if len(names) > 1 else "")
            left = self._rows.second
            imgui.same_line(left)
            width = imgui.get_content_region_avail().x / len(names)
            for index, name in enumerate(names):  # before the bars, which would lower them
                imgui.same_line(left + (index + 1) * width - em(2.3))
                muted(self._gui, _in_words(name, shown[name]))
            for index, share in enumerate(shares):
                imgui.same_line(left + index * width)
                imgui.progress_bar(min(share, 1.0), (width - em(2.8), em(1.0)), "")


def shown_of(face: LiveFace) -> dict[str, float]:
    """The channels that have come and where they are, calibrated; 0 while none comes."""
    calibrated = face.calibration.apply(face.channels)
    return calibrated if face.state is State.RECEIVING else dict.fromkeys(calibrated, 0.0)


def _share(channel: str, value: float) -> float:
    """How much of a bar a value fills; 1 is all."""
    return abs(value) / FULL_ANGLE if channel in ANGLES else value


def _in_words(channel: str, value: float) -> str:
    return f"{value:+.0f}\u00b0" if channel in ANGLES else f"{value:.2f}"


def state_in_words(face: LiveFace | None) -> str:
    """What can be said of who sends."""
    if face is None:
        return "not listening"
    who = f" {face.subject}" if face.subject else ""
    if face.state is State.RECEIVING:
        return f"receiving{who}, {face.rate:.0f} frames a second"
    if face.state is State.NO_FACE:
        return f"{who.strip() or 'the sender'} sees no face"
    if face.state is State.LOST:
        return f"lost{who}: nothing comes any more"
    if face.received:
        return (
            f"something comes to port {face.port}, but no face of {face.listening.protocol.title}: "
            "is the protocol right?"
        )
    return f"waiting on port {face.port}: nothing has come yet"


def advice_in_words(face: LiveFace, own_address: str) -> str:
    """What to do while nobody sends; "" if that is not known."""
    if face.state is not State.WAITING or face.received:
        return ""
    if face.listening.address == LOOPBACK:
        return "for a phone, listen to the whole network; without one, type: risorius send FILE"
    if face.listening.address == ANYWHERE and own_address:
        return f"in the app, let it send to {own_address}, port {face.port}"
    return f"in the app, let it send to port {face.port} of this computer"


def packets_in_words(face: LiveFace) -> str:
    """How many packets came, and how many were of no use."""
    unusable = f", of no use: {face.unusable}" if face.unusable else ""
    return f"packets: {face.received}{unusable}"
