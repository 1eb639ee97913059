"""Sounds that tests write."""

import wave
from pathlib import Path

import numpy as np
import scipy.signal

from risorius.geometry.arrays import Floats64

RATE = 16_000  # [samples/s]


def write_wav(path: Path, samples: Floats64, rate: int = RATE) -> Path:
    """Write a WAV file of samples from -1 to 1, (N,) or (N, C)."""
    whole = np.round(np.clip(samples, -1.0, 1.0) * 32_767).astype("<i2")
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1 if whole.ndim == 1 else whole.shape[1])
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(whole.tobytes())
    return path


def noise(seconds: float, rate: int = RATE, *, seed: int = 0) -> Floats64:
    """Noise without repetition, below 4 kHz, which codecs keep."""
    white = np.random.default_rng(seed).normal(0.0, 0.2, round(seconds * rate))
    low = scipy.signal.butter(4, 4000.0, fs=rate, output="sos")
    return np.asarray(scipy.signal.sosfilt(low, white))
