"""Labelled pictures of faces, each from its seed alone."""
