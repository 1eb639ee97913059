"""The sound of a script: read from a file, and played in time with the picture."""
