"""Recordings of a face by other programs: files and packets of their kinds, as one `Take`.

`read_take` reads one, a `Calibration` takes the face at rest away, and `controls_of` says which
controls of a face its channels move.
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
