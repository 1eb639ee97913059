"""Sounds that tests write for themselves: noise, and a voice that says mama."""

from __future__ import annotations

import wave
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy.signal

RATE = 16_000  # [samples/s] of the voice
HUM, OPEN = "m", "a"
# The resonances of the mouth [Hz], how wide each is [Hz], and how loud the whole.
FORMANTS = {
    HUM: ((270.0, 1000.0, 2200.0), (60.0, 300.0, 300.0), 0.25),
    OPEN: ((750.0, 1200.0, 2500.0), (90.0, 110.0, 170.0), 1.0),
}


def write_wav(path: Path, samples: npt.NDArray[np.float64], rate: int = RATE) -> Path:
    """A WAV of samples from -1 to 1, (N,) or (N, C)."""
    whole = np.round(np.clip(samples, -1.0, 1.0) * 32_767).astype("<i2")
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1 if whole.ndim == 1 else whole.shape[1])
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(whole.tobytes())
    return path


def noise(seconds: float, rate: int = RATE, *, seed: int = 0) -> npt.NDArray[np.float64]:
    """Noise that resembles itself at no other time; below 4 kHz, as codecs keep it."""
    white = np.random.default_rng(seed).normal(0.0, 0.2, round(seconds * rate))
    low = scipy.signal.butter(4, 4000.0, fs=rate, output="sos")
    return np.asarray(scipy.signal.sosfilt(low, white))


def voice(parts: Sequence[tuple[str, float]]) -> npt.NDArray[np.float64]:
    """A buzz through the resonances of a mouth: for each part its shape ("" is silence) and time.

    Source: Klatt 1980, "Software for a cascade/parallel formant synthesizer" (the cascade).
    """
    total = sum(seconds for _, seconds in parts)
    pitch = 120.0 + 8.0 * np.sin(np.linspace(0.0, 3.0, round(total * RATE)))  # [Hz]
    phase = np.cumsum(pitch) / RATE
    buzz = np.diff(np.floor(phase), prepend=0.0)
    buzz = scipy.signal.lfilter([1.0], [1.0, -0.95], buzz)
    spoken, gains = np.zeros_like(buzz), np.zeros_like(buzz)
    begin = 0
    for shape, seconds in parts:
        end = begin + round(seconds * RATE)
        if shape:
            frequencies, widths, loudness = FORMANTS[shape]
            part = buzz
            for frequency, width in zip(frequencies, widths, strict=True):
                radius = np.exp(-np.pi * width / RATE)
                back = [1.0, -2.0 * radius * np.cos(2.0 * np.pi * frequency / RATE), radius**2]
                part = scipy.signal.lfilter([sum(back)], back, part)
            spoken[begin:end] = part[begin:end] / np.abs(part).max()
            gains[begin:end] = loudness
        begin = end
    soft = np.hanning(round(0.02 * RATE))
    spoken *= np.convolve(gains, soft / soft.sum(), "same")
    hiss = np.random.default_rng(0).normal(0.0, 1e-3, len(spoken))
    return np.asarray(0.6 * spoken + hiss)
