"""Many commands, done one beside the other."""
