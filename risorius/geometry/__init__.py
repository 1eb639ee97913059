"""Computations on triangles and colours for several rooms.

All modules need numpy, and some need numba. Only mesh_graph.py needs scipy; `refine/` does not use
it.

arrays.py         types of arrays
carving.py        lines carved into a height map
closest.py        the closest points of a triangle mesh
colour.py         screen colours (sRGB) and linear light
directions.py     unit vectors
gradients.py      gradients of texture coordinates along a surface
intersections.py  where a surface cuts through itself
mesh_graph.py     connected pieces of a mesh, and paths along its edges
normals.py        cross products of triangles, normals of vertices, points on triangles
polylines.py      lengths along polylines
rays.py           where lines meet triangles
read_only.py      views that cannot be written
records.py        named tuples of arrays
sides.py          the sides and edges of triangles, as pairs of vertices
texels.py         the texels of a picture that triangles lie over
tones.py          colours of skin, composed texel by texel
transforms.py     points moved by matrices
vectors.py        vectors of three numbers in kernels
"""
