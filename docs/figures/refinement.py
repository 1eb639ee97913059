"""Draw the figures of docs/refinement.md: `python docs/figures/refinement.py [FOLDER]`.

refine_cases      the 27 split configurations and their triangulations
refine_masks      weights of the smoothing rules, first and second level
refine_lookup     numbering of points, and one triangle looked up
refine_sequences  the 271 sequences of splits
refine_tension    the face, coloured by stretch and compression
"""

from __future__ import annotations

from collections.abc import Sequence

import figures
import numpy as np
import numpy.typing as npt
from diagrams import FAINT, FILL, INK, MOVED, NEW, SECOND, Diagram, equilateral
from strain import tension_map

from risorius.app.files import Image
from risorius.refine.kahler.coherence import sequence_tables
from risorius.refine.kahler.table import POINTS, splits_of, subdivide

Places = npt.NDArray[np.float64]


def points_in(corners: Places) -> Places:
    """The 12 numbered points of a triangle with these corners, shape (12, 2)."""
    return np.asarray(POINTS @ corners / 4.0)


def new_points(splits: tuple[int, int, int]) -> list[int]:
    """Numbers of the points on split edges."""
    middles = [3 + 3 * edge for edge in range(3) if splits[edge]]
    quarters = [p + 3 * edge for edge in range(3) if splits[edge] == 2 for p in (4, 5)]
    return middles + quarters


def triangulation(
    diagram: Diagram,
    corners: Places,
    triangles: Sequence[Sequence[int]],
    splits: tuple[int, int, int],
    *,
    width: float = 1.2,
    radius: float = 2.6,
) -> None:
    """Draw one triangle cut up, its new points marked by level."""
    points = points_in(corners)
    diagram.polygon(list(corners), FILL)
    sides = {
        (min(a, b), max(a, b)) for t in triangles for a, b in zip(t, (*t[1:], t[0]), strict=True)
    }
    for a, b in sorted(sides):
        diagram.line([points[a], points[b]], INK, width)
    for number in new_points(splits):
        is_middle = number % 3 == 0
        diagram.disc(points[number], NEW if is_middle else SECOND, radius)


def cases() -> Image:
    """All 27 configurations in the order of the table, three to a column."""
    cell, columns = 96, 9
    diagram = Diagram(columns * cell, 3 * (cell + 14) + 8)
    for number in range(27):
        column, row = number % columns, number // columns
        centre = ((column + 0.5) * cell, diagram.size[1] - 8 - row * (cell + 14) - cell / 2)
        splits = splits_of(number)
        triangles = subdivide(splits)
        triangulation(diagram, equilateral(centre, 0.78 * cell), triangles, splits)
        title = f"{number}: {''.join(map(str, splits))}, {len(triangles)}"
        diagram.text((centre[0], centre[1] - 0.48 * cell), title, size=10.5)
    return diagram.image()


def sequences() -> Image:
    """The triangulations of all 271 sequences, by length."""
    tables = sequence_tables()
    cell, columns = 44, 20
    lengths = [len(sequence) for sequence in tables.sequences]
    rows = [-(-lengths.count(length) // columns) for length in range(7)]
    diagram = Diagram(columns * cell + 34, sum(rows) * cell + 7 * 8)
    top = float(diagram.size[1])
    for length in range(7):
        numbers = [k for k, own in enumerate(lengths) if own == length]
        diagram.text((16, top - cell / 2), str(length), FAINT, 15)
        for place, k in enumerate(numbers):
            column, row = place % columns, place // columns
            centre = (34 + (column + 0.5) * cell, top - (row + 0.5) * cell)
            sequence = tables.sequences[k]
            triangles = tables.patterns.of(k).tolist()
            splits = (sequence.count(0), sequence.count(1), sequence.count(2))
            triangulation(
                diagram, equilateral(centre, 0.86 * cell), triangles, splits, width=0.7, radius=1.1
            )
        top -= rows[length] * cell + 8
    return diagram.image()


def lookup() -> Image:
    """The numbers of the 12 points, and the way from splits to subtriangles."""
    diagram = Diagram(760, 250)
    corners = equilateral((140, 125), 200)
    points = points_in(corners)
    diagram.polygon(list(corners), FILL)
    diagram.line([*corners, corners[0]])
    centre = corners.mean(axis=0)
    for number, point in enumerate(points):
        colour = INK if number < 3 else NEW if number % 3 == 0 else SECOND
        diagram.disc(point, colour)
        outward = point - centre
        diagram.text(point + 13 * outward / np.linalg.norm(outward), str(number), colour, 12)
    for edge in range(3):
        inward = centre - points[3 + 3 * edge]
        diagram.text(
            points[3 + 3 * edge] + 22 * inward / np.linalg.norm(inward), f"edge {edge}", FAINT, 11
        )
    splits = (2, 0, 1)
    triangles = subdivide(splits)
    lines = [
        "splits of edges 0, 1, 2:  2, 0, 1",
        "2 + 3 · 0 + 9 · 1  =  entry 11",
        *(f"{a:3d} {b:3d} {c:3d}" for a, b, c in triangles),
    ]
    for row, text in enumerate(lines):
        diagram.text((290, 215 - 26 * row - 14 * (row > 1)), text, size=13, anchor="lm")
    right = equilateral((640, 125), 180)
    triangulation(diagram, right, triangles, splits)
    points = points_in(right)
    centre = right.mean(axis=0)
    for number in [0, 1, 2, *new_points(splits)]:
        outward = points[number] - centre
        diagram.text(points[number] + 13 * outward / np.linalg.norm(outward), str(number), size=11)
    return diagram.image()


def masks() -> Image:
    """Weights of the paper's rules (its Figs. 3 and 4)."""
    diagram = Diagram(900, 330)
    a_half, a_vertex = "border: 1/2, 1/2", "border: 3/4, 1/8, 1/8"
    for x, title, rule, border, marks in (
        (120, "first level", _first_level, a_half, (INK, NEW, INK)),
        (345, "vertex, valence n", _vertex_rule, a_vertex, (INK, MOVED, INK)),
        (570, "second level", _second_level, a_half, (MOVED, SECOND, NEW)),
        (790, "middle, moved again", _middle_again, a_vertex, (MOVED, NEW, MOVED)),
    ):
        diagram.text((x, 316), title, size=14)
        rule(diagram, x, 210)
        diagram.line([(x - 70, 52), (x + 70, 52)])
        for place, colour in zip((x - 70, x, x + 70), marks, strict=True):
            mark = diagram.square if colour == NEW else diagram.disc
            mark((place, 52), colour)
        diagram.text((x, 26), border, size=12)
    return diagram.image()


def _diamond(x: float, y: float, reach: float) -> tuple[Places, Places, Places, Places]:
    a, b = np.array([x - reach, y]), np.array([x + reach, y])
    c, d = np.array([x, y + 1.15 * reach]), np.array([x, y - 1.15 * reach])
    return a, b, c, d


def _outline(diagram: Diagram, a: Places, b: Places, c: Places, d: Places) -> None:
    diagram.polygon([a, d, b, c], FILL)
    diagram.line([a, b])
    diagram.line([a, c, b, d, a])


def _first_level(diagram: Diagram, x: float, y: float) -> None:
    a, b, c, d = _diamond(x, y, 72)
    _outline(diagram, a, b, c, d)
    for place, weight, side in ((a, "3/8", -1), (b, "3/8", 1)):
        diagram.disc(place, INK)
        diagram.text(place, weight, offset=(18 * side, 10))
    for place, weight, side in ((c, "1/8", 1), (d, "1/8", -1)):
        diagram.disc(place, INK)
        diagram.text(place, weight, offset=(20, 4 * side))
    diagram.square((x, y), NEW)


def _vertex_rule(diagram: Diagram, x: float, y: float) -> None:
    angles = 2.0 * np.pi * (np.arange(5) + 0.25) / 5
    ring = np.array([x, y]) + 74 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    diagram.polygon(list(ring), FILL)
    diagram.line([*ring, ring[0]])
    for place in ring:
        diagram.line([(x, y), place])
        diagram.disc(place, INK)
        diagram.text(np.array([x, y]) + 1.2 * (place - [x, y]), "b")
    diagram.disc((x, y), MOVED, 4)
    diagram.text((x + 36, y - 13), "1 - nb", MOVED)
    diagram.text((x, 95), "b = 3/(8n), 3/16 for n = 3", size=12)


def _second_level(diagram: Diagram, x: float, y: float) -> None:
    a, b, c, d = _diamond(x, y, 78)
    _outline(diagram, a, b, c, d)
    p, r, m = (a + c) / 2, (a + d) / 2, (a + b) / 2
    for place in (p, r):
        diagram.line([place, m], FAINT, dashed=True)
    diagram.disc(a, MOVED, 4)
    diagram.text(a, "3/8", offset=(-6, 18), colour=MOVED)
    diagram.square(m, NEW)
    diagram.text(m, "3/8", offset=(16, 13))
    for place, side in ((p, 1), (r, -1)):
        diagram.square(place, NEW, hollow=True)
        diagram.text(place, "1/8", offset=(-20, 6 * side))
    diagram.disc((a + m) / 2, SECOND, 3.6)
    for place in (b, c, d):
        diagram.disc(place, FAINT)


def _middle_again(diagram: Diagram, x: float, y: float) -> None:
    a, b, c, d = _diamond(x, y, 78)
    _outline(diagram, a, b, c, d)
    m = (a + b) / 2
    for start, end in ((a, c), (b, c), (a, d), (b, d)):
        place = (start + end) / 2
        diagram.line([place, m], FAINT, dashed=True)
        diagram.square(place, NEW, hollow=True)
        away = np.sign(place - m)
        diagram.text(place, "1/16", offset=(24 * away[0], 7 * away[1]))
    for place, side in ((a, -1), (b, 1)):
        diagram.disc(place, MOVED, 4)
        diagram.text(place, "1/16", offset=(2 * side, -17), colour=MOVED)
    for place in (c, d):
        diagram.disc(place, FAINT)
    diagram.square(m, NEW)
    diagram.text(m, "5/8", offset=(0, 16), colour=NEW)


FIGURES = {
    "refine_cases": cases,
    "refine_masks": masks,
    "refine_lookup": lookup,
    "refine_sequences": sequences,
    "refine_tension": tension_map,
}


def main(arguments: Sequence[str]) -> None:
    """Draw the figures into the folder given."""
    given = figures.parse(arguments, __doc__)
    figures.draw(given.folder, figures.chosen(FIGURES, given.only))


if __name__ == "__main__":
    figures.run(main)
