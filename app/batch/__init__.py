"""Many commands, done one beside the other: a list of lines, its journal, what became of them."""
