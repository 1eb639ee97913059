"""Beyond the paper: its future work (section 6) and what it leaves to others.

options.py            the refiner `kahler` with all its options
blending.py           points that grow out of their edges, so that nothing pops
curvature.py, border_turn.py, displacement.py, measuring.py     other criteria
cubic.py                                                    edges that are cubic curves
detail.py, fit.py, closest.py, axes.py                      what a finer mesh at rest has
surface_normals.py                                          normals of the refined surface
"""
