"""Avatars: heads with named shapes, on the built-in head or on a file's own vertices."""
