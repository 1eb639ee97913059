"""The panels around the picture: each file is one panel, drawn anew in every frame."""
