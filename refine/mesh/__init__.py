"""The mesh that a refiner is bound to: its edges, seams, normals and rings, checked and ordered."""
