"""Refiners to compare with: the mesh as it is, and Loop subdivision of all of it."""
