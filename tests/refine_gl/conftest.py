"""Fixtures of the card's tests."""

from .agreement import exact_driver

__all__ = ["exact_driver"]
