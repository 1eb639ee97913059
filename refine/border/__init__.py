"""The plug-in border: input and output of every refiner; plugin.py holds the protocol."""
