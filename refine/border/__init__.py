"""The border: input and output of every refiner; plugin.py holds the protocol."""
