"""Strain: how far the skin is stretched and compressed against rest, for artists. Not in the paper.

Both measures take a mesh at rest once and deformed positions in every frame (measure.py), and give
each vertex the mean over the triangles around it, weighted by their area at rest:

    Tension      the largest stretch and compression, and which way     (tension.py)
    Shortening   compression along directions that are given at rest    (shortening.py)
"""
