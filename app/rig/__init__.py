"""Heads as avatars: named shapes of a face, on the built-in head or a file's own vertices."""
