"""Many commands, done in parallel: a list of lines, its journal, their results."""
