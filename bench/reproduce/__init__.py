"""The paper repeated: its numbers and pictures, each beside our measurement."""
