"""Refinement of scenes: named presets, refiners with their options, and wrinkles."""
