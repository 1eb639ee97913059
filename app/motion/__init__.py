"""Scenes in motion: a script's frames one by one, and the life of a face that nobody moves."""

from .playing import SETTLING, counted_frames, play, scene_of, tally

__all__ = ["SETTLING", "counted_frames", "play", "scene_of", "tally"]
