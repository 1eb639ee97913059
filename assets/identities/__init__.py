"""Other persons than the built-in head."""

from .person import Person, make_person
from .traits import Identity, Sex, sample_identity

__all__ = ["Identity", "Person", "Sex", "make_person", "sample_identity"]
