"""Sound beside a script: read from a file, and played in step with the picture."""

from .decoding import LONGEST, Sound, load_sound, with_sound
from .player import Player

__all__ = ["LONGEST", "Player", "Sound", "load_sound", "with_sound"]
