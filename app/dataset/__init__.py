"""Labelled pictures of faces, which depend on their seed and number alone."""
