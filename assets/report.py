"""Mesh report of the built-in head: `python -m assets.report` writes it to standard output.

Distances are measured between vertices, straight, with the names of anthropometry. No published
norms stand beside them: the head is nobody, and a column of figures that was not checked against
its source would be worse than none.
"""

import sys
from dataclasses import dataclass

import numpy as np

from .checks import (
    component_count,
    euler_characteristic,
    fold_angles,
    is_manifold,
    is_mirrored,
    mirror_error,
    self_intersections,
)
from .generator.topology import boundary_loops, cross_products, smallest_angles
from .loading import load
from .model import Head

DISTANCES = (
    ("face height, n-gn", "nasion", "gnathion"),
    ("nose height, n-sn", "nasion", "subnasale"),
    ("lower face height, sn-gn", "subnasale", "gnathion"),
    ("nose protrusion, sn-prn", "subnasale", "pronasale"),
    ("upper lip height, sn-sto", "subnasale", "stomion"),
    ("upper red, ls-sto", "labiale_superius", "stomion"),
    ("lower red, sto-li", "stomion", "labiale_inferius"),
    ("forehead height, tr-n", "trichion", "nasion"),
    ("between inner eye corners, en-en", "endocanthion_right", "endocanthion_left"),
    ("between outer eye corners, ex-ex", "exocanthion_right", "exocanthion_left"),
    ("eye fissure length, en-ex", "endocanthion_left", "exocanthion_left"),
    ("eye fissure height, ps-pi", "palpebrale_superius_left", "palpebrale_inferius_left"),
    ("nose width, al-al", "alare_right", "alare_left"),
    ("mouth width, ch-ch", "cheilion_right", "cheilion_left"),
    ("face width, zy-zy", "zygion_right", "zygion_left"),
    ("jaw width, go-go", "gonion_right", "gonion_left"),
    ("ear to ear, t-t", "tragion_right", "tragion_left"),
)


@dataclass(frozen=True)
class Row:
    """One line of the report: what was measured, the value, its unit ("" for a count)."""

    title: str
    value: float
    unit: str = ""


def topology_rows(head: Head) -> list[Row]:
    """Counts that describe the mesh as a surface."""
    faces = head.faces
    return [
        Row("vertices", len(head.vertices)),
        Row("triangles", len(faces)),
        Row("boundary loops", len(boundary_loops(faces))),
        Row("pieces", component_count(faces)),
        Row("Euler characteristic", euler_characteristic(head.vertices, faces)),
        Row("manifold and consistently oriented", float(is_manifold(faces))),
        Row("mirror image of every face is a face", float(is_mirrored(faces, head.mirror))),
        Row("mirror error", mirror_error(head.vertices, head.mirror), "mm"),
    ]


def quality_rows(head: Head) -> list[Row]:
    """Numbers that describe the shape of the triangles."""
    vertices, faces = head.vertices, head.faces
    angle = smallest_angles(vertices, faces)
    area = 0.5 * np.linalg.norm(cross_products(vertices, faces), axis=1)
    folds = fold_angles(vertices, faces)
    corner = vertices[faces]
    length = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)
    return [
        Row("smallest angle", float(angle.min()), "deg"),
        Row("smallest angle, 1st percentile", float(np.percentile(angle, 1)), "deg"),
        Row("smallest angle, mean", float(angle.mean()), "deg"),
        Row("triangles with an angle below 15 deg", int((angle < 15.0).sum())),
        Row("edges folded by more than 120 deg", int((folds > 120.0).sum())),
        Row("self-intersecting pairs", len(self_intersections(vertices, faces))),
        Row("area", float(area.sum()) / 100.0, "cm2"),
        Row("shortest edge", float(length.min()), "mm"),
        Row("median edge", float(np.median(length)), "mm"),
        Row("longest edge", float(length.max()), "mm"),
    ]


def distance_rows(head: Head) -> list[Row]:
    """Anthropometric distances [mm]."""
    points = {name: head.vertices[vertex] for name, vertex in head.anatomy.items()}
    return [
        Row(title, float(np.linalg.norm(points[first] - points[second])), "mm")
        for title, first, second in DISTANCES
    ]


def report(head: Head) -> list[Row]:
    """Measure a head: surface, triangles, face."""
    return [*topology_rows(head), *quality_rows(head), *distance_rows(head)]


def main() -> None:
    """Write the report of the built-in head."""
    for row in report(load("head")):
        sys.stdout.write(f"{row.title:40s} {row.value:10.2f} {row.unit}\n")


if __name__ == "__main__":
    main()
