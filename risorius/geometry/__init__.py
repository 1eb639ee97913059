"""Computations on triangles and colours that several rooms share; numpy and numba only.

arrays.py       types of arrays
closest.py      the closest points of a triangle mesh
distances.py    distances of all points of one set from all of another
gradients.py    gradients of texture coordinates along a surface
normals.py      cross products of triangles, normals of vertices
polylines.py    the way along polylines
rays.py         where lines meet triangles
sides.py        the sides of triangles, as pairs of vertices
texels.py       the texels of a picture that triangles lie over
read_only.py    views that cannot be written
colour.py       screen colours (sRGB) and linear light
"""
