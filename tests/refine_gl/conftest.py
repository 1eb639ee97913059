"""What the tests of the card have in common."""

from .agreement import exact_driver

__all__ = ["exact_driver"]
