"""The script in time: its visible part, its keys in rows and as curves, its sound."""
