"""What other programs recorded of a face: files and packets of their kinds, as one `Take`.

`read_take` reads one, a `Calibration` takes the face at rest away, and a `MappingTable` says which
controls of a face its channels move.
"""

from .calibration import Calibration, calibration_for
from .mapping import MappingTable, load_mapping
from .reading import is_recording, read_take
from .take import Take

__all__ = [
    "Calibration",
    "MappingTable",
    "Take",
    "calibration_for",
    "is_recording",
    "load_mapping",
    "read_take",
]
