"""The border: what goes in and out of a refiner, whichever it is; plugin.py says what that is."""
