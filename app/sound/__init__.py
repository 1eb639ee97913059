"""Sound beside a script: read from a file, and played in step with the picture."""
