"""Playback of sound on a device, and the time in the sound that is heard now.

The library is miniaudio: MIT licence, wheels of half a megabyte for Linux, macOS and Windows and
each supported Python, and no further packages (sounddevice needs PortAudio on Linux, pygame and
pyglet have their own windows, soundcard only supports PulseAudio there). It requests samples when
the device needs them. So the number of requested samples measures time by the device's clock, and
the picture can follow it. To jump to another place, the player answers with other samples.
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
import time
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .decoding import Sound

try:
    import miniaudio
except ImportError:  # no wheel for this machine; everything else works without
    miniaudio = None

PERIOD_TIME = 0.04  # [s] of samples in one request
PERIOD_COUNT = 3  # periods that the device buffers before new samples are heard
Samples = npt.NDArray[np.int16]


class NoDeviceError(Exception):
    """This machine has no sound device; the text has the reason."""


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of the sound to play: from one time to another [s], at a speed."""

    start: float
    speed: float
    end: float
    since: float  # time of the request [s]


class Player:
    """Plays one sound on the device that the system prefers.

    Raises NoDeviceError if there is no device.
    """

    def __init__(self, sound: Sound, clock: Callable[[], float] = time.perf_counter) -> None:
        """clock: counts seconds; the device's own clock may run a little faster or slower."""
        self._sound = sound
        self._clock = clock
        self._device = open_device(sound.rate, sound.samples.shape[1])
        self._part: _Part | None = None
        # Time of the device's last request, the part that it got, and the length sent before [s].
        self._asked: tuple[float, _Part | None, float] = 0.0, None, 0.0

    @property
    def speed(self) -> float:
        """The speed; 0 if nothing plays."""
        return self._part.speed if self._part is not None else 0.0

    @property
    def position(self) -> float:
        """The current time in the sound [s]; the clock interpolates between two requests."""
        part = self._part
        (when, asked_for, given) = self._asked
        if part is None or asked_for is not part:
            return part.start if part is not None else 0.0
        since = min(self._clock() - when, 2.0 * PERIOD_TIME)  # a stuck device stays where it is
        heard = given - (PERIOD_COUNT - 1) * PERIOD_TIME + since
        return part.start + max(heard, 0.0) * part.speed

    @property
    def is_stuck(self) -> bool:
        """Whether the device requests no more samples, for example when unplugged."""
        part = self._part
        when = self._asked[0]
        # A device that makes no request for half a second is lost.
        return part is not None and self._clock() - max(when, part.since) > 0.5

    @property
    def is_heard(self) -> bool:
        """Whether the device plays a part that has not ended."""
        part = self._part
        return part is not None and self.position < part.end and not self.is_stuck

    def play(self, start: float, speed: float = 1.0, seconds: float = math.inf) -> None:
        """Play from a time of the sound [s] on, in place of the current part.

        speed: a speed other than 1 also changes the pitch. seconds: longest duration.
        """
        end = min(start + seconds * speed, self._sound.duration)
        self._part = _Part(start, speed, end, self._clock())
        if not self._device.running:
            samples = self._samples()
            next(samples)
            with contextlib.suppress(miniaudio.MiniaudioError):  # unplugged: nothing is heard
                self._device.start(samples)

    def stop(self) -> None:
        """Stop the sound; the device keeps running, so that it can restart at once."""
        self._part = None

    def rest(self) -> None:
        """Stop the sound and the device, for a longer pause."""
        self._part = None
        with contextlib.suppress(miniaudio.MiniaudioError):
            self._device.stop()

    def close(self) -> None:
        """Release the device."""
        self._device.close()

    def _samples(self) -> Generator[Samples | bytes, int, None]:
        """Answer each request for a number of frames, in the device's thread."""
        part = None
        given = 0
        count = yield b""
        while True:
            if part is not self._part:
                part = self._part
                given = 0
            self._asked = self._clock(), part, given / self._sound.rate
            chunk = self._chunk(part, given, count)
            given += count
            count = yield chunk

    def _chunk(self, part: _Part | None, first: int, count: int) -> Samples:
        """Return frames `first` to `first + count` of a part, (count, C); 0 outside the sound."""
        sound = self._sound.samples
        rate = self._sound.rate
        chunk = np.zeros((count, sound.shape[1]), np.int16)
        if part is not None:
            positions = part.start * rate + part.speed * np.arange(first, first + count)
            is_in = (positions >= 0.0) & (positions < part.end * rate)
            chunk[is_in] = sound[positions[is_in].astype(np.int64)]
        return chunk


def open_device(rate: int, channels: int) -> Any:
    """Open the device that the system prefers, stopped; raise NoDeviceError if there is none."""
    if miniaudio is None:
        raise NoDeviceError("miniaudio is not installed (in the checkout: pip install '.[window]')")
    try:
        return miniaudio.PlaybackDevice(
            output_format=miniaudio.SampleFormat.SIGNED16,
            nchannels=channels,
            sample_rate=rate,
            buffersize_msec=round(1000.0 * PERIOD_TIME),
            callback_periods=PERIOD_COUNT,
            backends=backends(),
            app_name="Risorius",
        )
    except miniaudio.MiniaudioError:
        raise NoDeviceError("there is no device to play on") from None


def backends() -> list[Any]:
    """Return the system's interfaces to sound devices, in miniaudio's order."""
    kinds = miniaudio.Backend
    unwanted = {kinds.NULL, kinds.CUSTOM, kinds.JACK}  # a server that is rarely the only interface
    if sys.platform == "linux" and not os.path.exists("/dev/snd"):
        unwanted.add(kinds.ALSA)  # like JACK it prints long complaints about missing devices
    found = miniaudio.get_enabled_backends() - unwanted
    return sorted(found, key=lambda backend: int(backend.value))
