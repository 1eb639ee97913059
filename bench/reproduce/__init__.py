"""The paper, made anew: its numbers and pictures, each beside our measurement."""
