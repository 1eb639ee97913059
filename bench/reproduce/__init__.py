"""Repeat the paper's numbers and pictures, each beside our measurement."""
