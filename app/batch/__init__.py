"""Parallel runs of many commands: the list of lines, their logs and their results."""
