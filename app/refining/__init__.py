"""How scenes are refined: looks by name, refiners bound as a look has them, and wrinkles."""
