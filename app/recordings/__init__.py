"""Recordings of a face by other programs, read into one common form, the `Take`.

`read_take` reads a file, a `Calibration` subtracts the neutral face, and `controls_of` converts
channels to controls of the simulated face.
"""

from .calibration import Calibration, calibration_for
from .mapping import controls_of
from .reading import is_recording, read_take
from .take import Take

__all__ = [
    "Calibration",
    "Take",
    "calibration_for",
    "controls_of",
    "is_recording",
    "read_take",
]
