"""Offscreen capture: a script becomes a film, a folder of frames, a picture or a contact sheet."""

from .drawing import Capture, CaptureOptions
from .recording import capture

__all__ = ["Capture", "CaptureOptions", "capture"]
