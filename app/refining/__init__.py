"""Refinement of scenes: presets by name, refiners bound with their options, and wrinkles."""
