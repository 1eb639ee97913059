"""Large meshes in a careless order: walked in an order in which neighbours are neighbours.

The passes of a frame follow triangles to their vertices and edges to their ends. In a large mesh
whose vertices or triangles were shuffled each step leads to memory that has left the processor's
caches: a million triangles take three times as long (measured). So such a mesh is renumbered when
it is bound, and everything inside works with the new numbers:

    vertices and triangles   along a curve that fills space (Morton 1966), by the rest positions
    vertices then            by their first use in these triangles, so that both stream

It is found by counting, not by timing, so that the same mesh always gives the same output: how
often a cache would have to fetch anew what it has had before. A mesh that the cache holds never
does, and one in a sensible order hardly; both are left as they are.

Outside nothing changes but the order of triangles and edges: `source` names the caller's
triangles, row v of the output is vertex v. Not in the paper.
"""

from dataclasses import dataclass, field, replace
from typing import cast

import numpy as np
import numpy.typing as npt

from .arguments import CornerValues
from .kernels import kernel

Doubles = npt.NDArray[np.float64]
Floats = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int32]
Unsigned = npt.NDArray[np.uint32]
Wide = npt.NDArray[np.int64]

CACHE_LINES = 8192
"""Lines of the cache that is thought of, a power of two: with LINE half a megabyte, the second
level of one core today; so meshes below 21 845 vertices are never renumbered."""
LINE, ROW = 64, 24
"""Bytes of a line, and of the position of a vertex in double precision."""
MOST_FETCHED_ANEW = 0.2
"""Lines for each triangle above which a mesh is renumbered: where the two copies that it costs in
every frame are paid for. Measured on sheets of 50 000 to a million triangles, how much faster a
frame is: at 0.1 to 0.2, 0.95 to 1.05 times up to 200 000 triangles; at 0.3 (vertices shuffled), 1.1
to 2.3 times; at 1 to 2.7 (triangles shuffled), 1.3 to 3.6 times."""
GEOMETRY = 6
"""x y z, nx ny nz: columns of a row before attributes."""
CELLS_BITS = 20
"""Of the grid along one axis that the curve runs through."""


@dataclass
class Order:
    """New numbers of the vertices and triangles of a mesh."""

    vertices: Unsigned
    """The caller's number of each vertex, shape (V,)."""
    faces: Unsigned
    """The caller's number of each triangle, shape (F,)."""
    moves: Unsigned
    """Vertices cycle by cycle: each gets its row in the caller's order from the next one."""
    cycles: Unsigned
    """Where in `moves` each cycle begins, and the end, shape (C + 1,)."""
    _converted: Doubles | None = field(default=None, init=False)

    def sorted_values(self, given: CornerValues | None) -> CornerValues | None:
        """Values of corners for the renumbered mesh, they too in the order of their first use."""
        if given is None:
            return None
        if given.corners is None:
            return replace(given, values=given.values[self.vertices])
        corners = given.corners[self.faces].astype(np.uint32)
        rows = number_by_use(corners.reshape(-1), len(given.values))
        return replace(given, values=given.values[rows], corners=corners.astype(np.int64))

    def named_edges(self, edges: Indices) -> Indices:
        """End points of edges, shape (E, 2), by the caller's numbers; read only."""
        named = self.vertices[edges].view(np.int32)
        named.flags.writeable = False
        return named

    def given_faces(self, rows: Indices) -> Indices:
        """Rows of triangles, shape (F, 3), in the caller's order; read only."""
        given = np.empty_like(rows)
        given[self.faces] = rows
        given.flags.writeable = False
        return given

    def named(self, rows: Unsigned) -> Unsigned:
        """Numbers of vertices by the caller's; those above (copies along seams) as they are."""
        is_vertex = rows < len(self.vertices)
        return np.where(is_vertex, self.vertices[np.where(is_vertex, rows, 0)], rows)

    def gather(self, positions: npt.NDArray[np.floating], gathered: Doubles) -> None:
        """Write the caller's `positions`, shape (V, 3), in the new order into `gathered`."""
        if positions.dtype != np.float64 or not positions.flags.c_contiguous:
            if self._converted is None:
                self._converted = np.empty_like(gathered)
            np.copyto(self._converted, positions)
            gather_rows(self._converted, self.vertices, gathered)
        else:
            gather_rows(cast(Doubles, positions), self.vertices, gathered)

    def give_back(self, rows: Floats, source: Indices) -> None:
        """Bring the rows of vertices, and the names of triangles, to the caller's order."""
        move_rows(self.moves, self.cycles, rows)
        rename(source, self.faces)


def better_order(faces: Wide, positions: Doubles) -> tuple[Order, Unsigned] | None:
    """Return an order for triangles, shape (F, 3), and these renumbered.

    None where the order of the caller will do. `positions`: of the vertices at rest, shape (V, 3).
    """
    if len(positions) * ROW <= CACHE_LINES * LINE:
        return None  # the cache holds all of it; this spares small meshes to load a kernel
    if count_fetched_anew(faces, len(positions), CACHE_LINES) <= MOST_FETCHED_ANEW * len(faces):
        return None
    along = np.argsort(places_on_curve(positions), kind="stable")
    place = np.empty(len(along), dtype=np.uint32)
    place[along] = np.arange(len(along), dtype=np.uint32)
    walked = sorted_by_lowest(faces, place)
    renumbered = faces[walked].astype(np.uint32)
    vertices = number_by_use(renumbered.reshape(-1), len(positions))
    return Order(vertices, walked, *list_cycles(vertices)), renumbered


def places_on_curve(positions: Doubles) -> Wide:
    """How far along a curve that fills space each position lies, shape (V,)."""
    low = positions.min(axis=0)
    size = float((positions.max(axis=0) - low).max())
    cells = np.zeros(len(positions), dtype=np.int64)
    interleave_cells(positions, low, (2**CELLS_BITS - 1) / size if size > 0.0 else 0.0, cells)
    return cells


@kernel
def count_fetched_anew(faces: Wide, vertex_count: int, cache_lines: int) -> int:
    """Count the lines of memory that a cache has to fetch once more on the way over all corners.

    Each line has one place in the cache, the remainder of its number: simple, and little is lost.
    """
    cached = np.full(cache_lines, -1, np.int32)
    was_fetched = np.zeros(vertex_count * ROW // LINE + 1, np.bool_)
    count = 0
    for t in range(faces.shape[0]):
        for i in range(3):
            line = np.int32(faces[t, i] * ROW // LINE)
            place = line & (cache_lines - 1)
            if cached[place] != line:
                cached[place] = line
                count += was_fetched[line]
                was_fetched[line] = True
    return count


@kernel
def interleave_cells(positions: Doubles, low: Doubles, scale: float, cells: Wide) -> None:
    """Write the number of each position's cell: the bits of x, y and z in turn (Morton's curve)."""
    for v in range(positions.shape[0]):
        number = np.int64(0)
        for i in range(3):
            cell = np.int64((positions[v, i] - low[i]) * scale)
            for bit in range(CELLS_BITS):
                number |= ((cell >> bit) & 1) << (3 * bit + i)
        cells[v] = number


@kernel
def sorted_by_lowest(faces: Wide, place: Unsigned) -> Unsigned:
    """Sort triangles by the lowest `place`, shape (V,), of their vertices; shape (F,)."""
    starts = np.zeros(len(place) + 1, np.int64)
    lowest = np.empty(faces.shape[0], np.uint32)
    for t in range(faces.shape[0]):
        lowest[t] = min(place[faces[t, 0]], place[faces[t, 1]], place[faces[t, 2]])
        starts[lowest[t] + 1] += 1
    for v in range(len(place)):
        starts[v + 1] += starts[v]
    walked = np.empty(faces.shape[0], np.uint32)
    for t in range(faces.shape[0]):
        walked[starts[lowest[t]]] = t
        starts[lowest[t]] += 1
    return walked


@kernel
def number_by_use(used: Unsigned, count: int) -> Unsigned:
    """Number 0 .. `count` - 1 anew in the order of their first use, those never used last.

    The numbers in `used` are replaced by the new ones. Returns the old one of each, (count,).
    """
    number = np.full(count, -1, np.int64)
    olds = np.empty(count, np.uint32)
    next_number = 0
    for k in range(len(used)):
        old = used[k]
        if number[old] < 0:
            number[old] = next_number
            olds[next_number] = old
            next_number += 1
        used[k] = number[old]
    for old in range(count):
        if number[old] < 0:
            olds[next_number] = old
            next_number += 1
    return olds


@kernel
def list_cycles(vertices: Unsigned) -> tuple[Unsigned, Unsigned]:
    """Take apart the order of vertices into cycles; see `Order.moves` and `Order.cycles`."""
    count = len(vertices)
    number = np.empty(count, np.uint32)
    for k in range(count):
        number[vertices[k]] = k
    is_listed = np.zeros(count, np.bool_)
    moves, cycles = np.empty(count, np.uint32), np.empty(count + 1, np.uint32)
    move_count = cycle_count = 0
    for first in range(count):
        if is_listed[first] or number[first] == first:
            continue
        cycles[cycle_count] = move_count
        cycle_count += 1
        row = first
        while not is_listed[row]:
            is_listed[row] = True
            moves[move_count] = row
            move_count += 1
            row = number[row]
    cycles[cycle_count] = move_count
    return moves[:move_count].copy(), cycles[: cycle_count + 1].copy()


@kernel
def gather_rows(positions: Doubles, vertices: Unsigned, gathered: Doubles) -> None:
    """Write row `vertices[k]` of positions into row k, shape (V, 3)."""
    for k in range(len(vertices)):
        v = vertices[k]
        for i in range(3):
            gathered[k, i] = positions[v, i]


@kernel
def move_rows(moves: Unsigned, cycles: Unsigned, rows: Floats) -> None:
    """Give each row in `moves` what the next one of its cycle has, without a second array.

    Which rows come next is known beforehand, so that many reads are under way at a time.
    """
    one, columns = np.uint32(1), rows.shape[1]
    kept = np.empty(columns, np.float32)
    for c in range(len(cycles) - 1):
        to = moves[cycles[c]]
        for i in range(columns):
            kept[i] = rows[to, i]
        for k in range(cycles[c] + one, cycles[c + 1]):
            from_ = moves[k]
            for i in range(GEOMETRY):  # so many that the compiler knows, copied at one go
                rows[to, i] = rows[from_, i]
            for i in range(GEOMETRY, columns):
                rows[to, i] = rows[from_, i]
            to = from_
        for i in range(columns):
            rows[to, i] = kept[i]


@kernel
def rename(source: npt.NDArray[np.int32], names: Unsigned) -> None:
    """Replace every number in `source` by its name."""
    for k in range(len(source)):
        source[k] = names[source[k]]
