"""Shared by the tests of the card."""

from .agreement import exact_driver

__all__ = ["exact_driver"]
