"""What lies under the skin, drawn through it: muscles and skull, as solids."""

from .dissection import OPACITY, SIDES, SOLIDS, Dissection, Solids

__all__ = ["OPACITY", "SIDES", "SOLIDS", "Dissection", "Solids"]
