"""The arrays that are uploaded once per mesh: indices and weights, one after another.

A storage buffer is one array, and OpenGL 4.3 guarantees a pass only eight of them. So all arrays
lie in one buffer, and a shader reads `faces(k)`, a macro that adds the place where `faces` begins.
A uniform block has these places and the lengths of all arrays.
"""

from typing import NamedTuple

import numpy as np

from risorius.geometry.arrays import Floats32, Unsigned32
from risorius.refine import Connectivity, port

from .rules import Arrays, Rules

GROUP_SIZE = 256
"""Threads of a group for prefix sums: OpenGL 4.3 guarantees 1024."""


class Tables(NamedTuple):
    """The data of one mesh for the shaders."""

    words: Unsigned32
    """All its arrays, one after another; floats are stored by their bits."""
    sizes: dict[str, int]
    """Numbers of the uniform block: counts, and the first place of each array as `NAME_at`."""
    limits: dict[str, float]
    """Its other numbers, which may be infinite."""
    head: str
    """The first lines of shaders: switches, the uniform block, a macro for each array."""
    field_count: int
    """Number of vectors in the buffer that passes share."""
    work_count: int
    """Number of numbers in the buffer that passes share."""


def tables_of(mesh: Connectivity, values: Floats32, rules: Rules) -> Tables:
    """Lay out the data of a mesh. `values`: texture coordinates and attributes, shape (A, k)."""
    arrays = {**_arrays(mesh, values), **rules.arrays()}
    sizes = _counts(mesh, values.shape[1], arrays, rules)
    views = {}
    words = [np.zeros(0, np.uint32)]
    for name, array in arrays.items():
        sizes[f"{name}_at"] = sum(map(len, words))
        kind = np.float32 if array.dtype == np.float32 else np.uint32
        words.append(np.ascontiguousarray(array, kind).ravel().view(np.uint32))
        views[name] = f"mesh[{name}_at + (k)]"
        if kind is np.float32:
            views[name] = f"uintBitsToFloat({views[name]})"
    fields = rules.fields()
    work = _work(mesh, sizes)
    for buffer, parts in (("fields", fields), ("work", work)):
        for place, name in enumerate(parts):
            sizes[f"{name}_at"] = sum(list(parts.values())[:place])
            views[name] = f"{buffer}[{name}_at + (k)]"
    for name in ("rest_cosines", "measured"):
        views[name] = f"uintBitsToFloat({views[name]})"
    limits = rules.limits
    lines = [
        *(f"#define {name}" for name in rules.switches),
        f"#define GROUP {GROUP_SIZE}",
        f"#define CENTRE {port.CENTRE_POINT}",
        "layout(std140, binding = 0) uniform Sizes {",
        *(f"float {name};" for name in limits),
        *(f"uint {name};" for name in sizes),
        "};",
        *(f"#define {name}(k) {code}" for name, code in views.items()),
    ]
    counts = sum(fields.values()), sum(work.values())
    return Tables(np.concatenate(words), sizes, limits, "\n".join(lines), *counts)


def groups_of(threads: int) -> int:
    """Number of groups for this many threads."""
    return -(-threads // GROUP_SIZE)


def _counts(mesh: Connectivity, value_count: int, arrays: Arrays, rules: Rules) -> dict[str, int]:
    """The number of elements of each kind; for rows and subtriangles the largest number."""
    rows = len(mesh.wedge_vertices) + 3 * len(mesh.attribute_edges)
    return {
        "vertex_count": mesh.vertex_count,
        "first_vertex": mesh.first_vertex,
        "edge_count": len(mesh.edges),
        "wedge_count": len(mesh.wedge_vertices),
        "attribute_edge_count": len(mesh.attribute_edges),
        "face_count": len(mesh.faces),
        "value_count": value_count,
        "columns": port.GEOMETRY_COLUMNS + value_count,
        "attribute_edge_blocks": groups_of(len(mesh.attribute_edges)),
        "face_blocks": groups_of(len(mesh.faces)),
        "most_rows": rows + len(mesh.faces) * rules.blends,
        "most_subtriangles": arrays["patterns"].size // arrays["counts"].size,
    }


def _work(mesh: Connectivity, sizes: dict[str, int]) -> dict[str, int]:
    """Numbers that passes share: name -> count; not every pass uses all."""
    edges = len(mesh.edges)
    faces = len(mesh.faces)
    return {
        "splits": len(mesh.attribute_edges),
        "first_points": len(mesh.attribute_edges),
        "moved_frames": mesh.vertex_count,
        "configurations": faces,
        "first_triangles": faces,
        "first_centres": faces,
        "states": faces,
        "removals": 1,
        "rest_cosines": edges,
        "measured": edges,
        "blocks": sizes["attribute_edge_blocks"] + 2 * sizes["face_blocks"],
    }


def _arrays(mesh: Connectivity, values: Floats32) -> Arrays:
    """The connectivity, the corners around each vertex in the order of triangles, and values.

    Values are texture coordinates and attributes, of wedges and at both ends of attribute edges.
    """
    corners = mesh.faces.ravel()
    sums = np.cumsum(np.bincount(corners, minlength=mesh.vertex_count))
    return {
        "faces": mesh.faces,
        "corners": mesh.corners,
        "corner_starts": np.concatenate([[0], sums]),
        "vertex_corners": np.argsort(corners, kind="stable"),
        "edge_points": mesh.around.points,
        "attribute_edges": mesh.attribute_edges,
        "triangle_attribute_edges": mesh.triangle_attribute_edges,
        "wedge_vertices": mesh.wedge_vertices,
        "wedge_values": port.wedge_values(mesh, values),
        "edge_values": values[mesh.attribute_edge_uv],
    }
