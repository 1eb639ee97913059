"""Make avatars: heads with named shapes, with the vertices of a file or of the built-in head."""
