"""Meshes as other programs keep them: vertices doubled along seams, any data at vertices and faces.

Nothing here imports another program; `from_trimesh` knows its meshes by their attributes.
"""
