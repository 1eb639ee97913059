"""The border: what goes in and out of a refiner, whichever it is.

plugin.py says what a refiner is, registry.py finds it by name, base.py is what the built-in ones
share, with corner_values.py, rows.py and stream.py; checker.py judges what they make.
"""
