"""The one exception that means: tell the user in one line and stop with exit code 2."""

from __future__ import annotations


class UserError(Exception):
    """Something the user gave cannot be used; the text says what, where, what is allowed."""
