"""The script in time: which part of it is seen, its keys in rows and as curves, its sound."""
