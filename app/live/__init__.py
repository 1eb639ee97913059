"""Faces that are sent while they move: sockets, packets, and what is done when nobody sends."""
