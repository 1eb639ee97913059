"""The panels around the picture: each file is one panel, which is drawn in every frame."""
