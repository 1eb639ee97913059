"""Faces that are sent while they move: sockets, packets, and a face that eases in and out."""
