"""Fixtures of the graphics card's tests."""

from .agreement import exact_driver

__all__ = ["exact_driver"]
