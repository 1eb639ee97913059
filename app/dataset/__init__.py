"""Labelled pictures of faces, each made from its seed alone."""
