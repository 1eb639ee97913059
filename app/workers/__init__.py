"""Processes that work on many things at once, here or on a cluster."""
