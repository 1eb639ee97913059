"""Offscreen capture: a script becomes a film, a folder of frames, a picture or a contact sheet."""

from .recording import Capture, CaptureOptions, capture

__all__ = ["Capture", "CaptureOptions", "capture"]
