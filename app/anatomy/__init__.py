"""What lies under the skin, drawn through it: muscles and skull, as solids."""

from .anatomy_view import OPACITY, SIDES, SKIN_ALONE, STRUCTURES, Anatomy, AnatomyView, Layers

__all__ = ["OPACITY", "SIDES", "SKIN_ALONE", "STRUCTURES", "Anatomy", "AnatomyView", "Layers"]
