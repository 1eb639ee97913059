"""Many commands, done side by side: a list of lines, its journal, their results."""
