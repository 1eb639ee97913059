"""What other programs recorded of a face: files and packets of their kinds, as one `Take`."""

from .take import Take

__all__ = ["Take"]
