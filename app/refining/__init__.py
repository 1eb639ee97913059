"""How scenes are refined: presets by name, refiners bound as a preset has them, and wrinkles."""
