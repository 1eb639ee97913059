"""What other programs recorded of a face: files and packets of their kinds, as one `Take`."""

from .reading import is_recording, read_take
from .take import Take

__all__ = ["Take", "is_recording", "read_take"]
