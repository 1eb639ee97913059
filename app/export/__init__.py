"""The motion of a script, as files that other programs read."""
