"""Skin beside scans of skin: how well muscles move it, and how well they foretell what is new."""
