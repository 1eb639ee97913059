"""Draw the figure of docs/one_topology.md: `python docs/figures/one_topology.py [FOLDER]`.

one_topology      the same triangles in two frames of a clip, four of their vertices numbered

Pillow draws the triangles from back to front, at three times the size; then the picture is reduced.
"""

from __future__ import annotations

import figures
import numpy as np
from refinement import INK_COLOUR, NEW_COLOUR, PAPER_COLOUR, SECOND_COLOUR, Colour, Diagram

from risorius import assets, refine, sim
from risorius.app.pictures import Image
from risorius.bench.subjects import SETTLING_FRAMES, settled_positions
from risorius.geometry.arrays import Flags, Floats64
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import cross_products

LIGHT_DIRECTION = np.array([-0.35, 0.45, 0.82])
PANEL_SIZE = (420, 480)
CAPTION_HEIGHT = 24  # pixels below the panels


def shaded(colour: Colour, light: float) -> Colour:
    """A colour shaded by the cosine between normal and light, 0 to 1."""
    red, green, blue = (round(part * (0.55 + 0.45 * light)) for part in colour)
    return red, green, blue


def draw_frame(
    diagram: Diagram, mesh: refine.RefinedMesh, is_split: Flags, left: float
) -> Floats64:
    """Draw the triangles that face the reader; return the places of all vertices, (N, 2)."""
    width, height = PANEL_SIZE
    centre = np.array([left + width / 2.0, CAPTION_HEIGHT + height / 2.0])
    pixels = 2.45  # pixels per millimetre
    middle = (0.0, -22.0)  # point of the face [mm] in the middle of a panel
    positions = mesh.positions.astype(np.float64)
    normals = unit_vectors(cross_products(positions, mesh.triangles))
    places = centre + pixels * (positions[:, :2] - middle)
    aside = np.abs(places[mesh.triangles, 0] - centre[0])
    is_inside = (aside < width / 2.0).all(axis=1)
    is_shown = is_inside & (normals[:, 2] > 0.0)
    depth = positions[mesh.triangles, 2].mean(axis=1)
    split = (163, 204, 232)  # colour of parts of split triangles
    whole = (242, 240, 236)
    edge = (150, 154, 162)
    for k in np.argsort(depth):
        if not is_shown[k]:
            continue
        outline = places[mesh.triangles[k]]
        fill = split if is_split[mesh.source[k]] else whole
        light = max(float(normals[k] @ LIGHT_DIRECTION), 0.0)
        diagram.polygon(list(outline), shaded(fill, light))
        diagram.line([*outline, outline[0]], edge, 0.5)
    right = left + width
    strip = [(left, 0), (right, 0), (right, CAPTION_HEIGHT), (left, CAPTION_HEIGHT)]
    diagram.polygon(strip, PAPER_COLOUR)
    return places


def one_topology() -> Image:
    """A face in two expressions, with the splits that either expression needs."""
    head = assets.load("head")
    simulation = sim.create(head)
    expressions = ("joy", "surprise")
    frames = [
        settled_positions(simulation, head.expressions[each], SETTLING_FRAMES)
        for each in expressions
    ]
    free = refine.create("kahler", head.faces, head.vertices)
    splits = refine.splits_of_clip(free, frames)
    refiner = refine.create("kahler", head.faces, head.vertices, splits=splits)
    is_split: Flags = np.any(splits[refiner.triangle_edges], axis=1)
    diagram = Diagram(2 * PANEL_SIZE[0], PANEL_SIZE[1] + CAPTION_HEIGHT)
    for panel, (expression, frame) in enumerate(zip(expressions, frames, strict=True)):
        mesh = refiner.refine(frame)
        left = panel * PANEL_SIZE[0]
        places = draw_frame(diagram, mesh, is_split, left)
        if panel == 0:
            marked = numbered(mesh, refiner.vertex_capacity)
        for vertex in marked:
            diagram.disc(places[vertex], SECOND_COLOUR, 3.2)
            diagram.text(places[vertex] + [0.0, 11.0], str(vertex), INK_COLOUR, 12.0)
        words = f"{expression}: {mesh.vertex_count} vertices, {mesh.triangle_count} triangles"
        diagram.text((left + PANEL_SIZE[0] / 2.0, CAPTION_HEIGHT / 2.0), words, NEW_COLOUR, 13.0)
    return diagram.image()


def numbered(mesh: refine.RefinedMesh, count: int) -> list[int]:
    """Vertices near a brow, a cheek, a corner of the mouth and the chin."""
    brow = (-28.0, 28.0)
    cheek = (34.0, -28.0)
    corner = (-26.0, -50.0)
    chin = (0.0, -82.0)
    wanted = np.array([brow, cheek, corner, chin])
    front = np.flatnonzero(mesh.normals[:count, 2] > 0.4)
    places = mesh.positions[front, None, :2]
    apart = np.linalg.norm(places - wanted, axis=2)
    return [int(front[k]) for k in apart.argmin(axis=0)]


if __name__ == "__main__":
    figures.run(__doc__, {"one_topology": one_topology})
