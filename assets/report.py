"""Mesh report of the built-in head, printed by `python -m risorius.assets.report`.

Distances are measured between vertices, straight, with the names of anthropometry. Beside them
stand the published means of adults, where there are such (`norms`), and how many deviations the
head lies above or below them. The head is nobody, and of no sex: it is held against both.
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
from .loading import load
from .model import Head
from .norms import DEPTHS, NORMS, WEINBERG_2016, Norm
from .topology import boundary_loops, cross_products, smallest_angles

DISTANCES = (
    ("face height, n-gn", "nasion", "gnathion"),
    ("nose height, n-sn", "nasion", "subnasale"),
    ("lower face height, sn-gn", "subnasale", "gnathion"),
    ("nose bridge, n-prn", "nasion", "pronasale"),
    ("nose protrusion, sn-prn", "subnasale", "pronasale"),
    ("upper lip height, sn-sto", "subnasale", "stomion"),
    ("philtrum length, sn-ls", "subnasale", "labiale_superius"),
    ("upper red, ls-sto", "labiale_superius", "stomion"),
    ("lower red, sto-li", "stomion", "labiale_inferius"),
    ("skin of the lower lip, li-sl", "labiale_inferius", "sublabiale"),
    ("forehead height, tr-n", "trichion", "nasion"),
    ("between inner eye corners, en-en", "endocanthion_right", "endocanthion_left"),
    ("between outer eye corners, ex-ex", "exocanthion_right", "exocanthion_left"),
    ("eye fissure length, en-ex", "endocanthion_left", "exocanthion_left"),
    ("eye fissure height, ps-pi", "palpebrale_superius_left", "palpebrale_inferius_left"),
    ("nose width, al-al", "alare_right", "alare_left"),
    ("mouth width, ch-ch", "cheilion_right", "cheilion_left"),
    ("philtrum width, cph-cph", "crista_philtri_right", "crista_philtri_left"),
    ("forehead width, ft-ft", "frontotemporale_right", "frontotemporale_left"),
    ("face width, zy-zy", "zygion_right", "zygion_left"),
    ("jaw width, go-go", "gonion_right", "gonion_left"),
    ("ear to ear, t-t", "tragion_right", "tragion_left"),
)

# Where the depth of bone is shown; the right side has the same.
DEPTH_NAMES = (
    "vertex", "trichion", "glabella", "nasion", "rhinion", "subnasale", "labiale_superius",
    "labiale_inferius", "sublabiale", "pogonion", "gnathion", "menton", "orbitale_left",
    "alar_base_left", "cheek_left", "zygion_left", "gonion_left",
)  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One line of the report: what was measured, the value, its unit ("" for a count)."""

    title: str
    value: float
    unit: str = ""

    @property
    def norm(self) -> Norm | None:
        """What the value is compared with: that of the code behind the comma, as in "..., n-gn"."""
        return NORMS.get(self.title.rpartition(", ")[2])


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


def _markdown(titles: str, rows: list[list[str]]) -> list[str]:
    """A table in Markdown; titles: those of its columns, between bars."""
    lines = [f"| {titles} |", "|---" * (titles.count("|") + 1) + "|"]
    return [*lines, *(f"| {' | '.join(cells)} |".replace("  ", " ") for cells in rows)]


def mesh_table(head: Head) -> list[str]:
    """What describes the mesh as a surface and its triangles."""
    rows = [*topology_rows(head), *quality_rows(head)]
    return _markdown("mesh | ours", [[row.title, f"{row.value:.6g} {row.unit}"] for row in rows])


def distance_table(head: Head) -> list[str]:
    """The distances, with means and deviations [mm] of both sexes, and whom they are usual for."""
    rows = []
    for row in distance_rows(head):
        cells = [row.title, f"{row.value:.1f}"]
        if row.norm is None:
            cells += [""] * 5
        else:
            for sample in (row.norm.women, row.norm.men):
                cells.append(f"{sample.mean:.1f} ± {sample.deviation:.1f}")
                cells.append(f"{sample.score(row.value):+.1f}")
            cells.append(row.norm.usual_for(row.value))
        rows.append(cells)
    return _markdown("measure | ours | women | score | men | score | usual for", rows)


def depth_table(head: Head) -> list[str]:
    """How deep bone lies below named points [mm], with what was published."""
    rows = []
    for name in DEPTH_NAMES:
        ours = float(head.bone_depth[head.anatomy[name]])
        cells = [name.removesuffix("_left").replace("_", " "), f"{ours:.1f}"]
        if name in DEPTHS:
            sample, source = DEPTHS[name]
            published = f"{sample.mean:.1f} ± {sample.deviation:.1f}"
            cells += [published, f"{sample.score(ours):+.1f}", source]
        else:
            cells += [""] * 3
        rows.append(cells)
    return _markdown("bone below | ours | published | score | measured on", rows)


def main() -> None:
    """Write the report of the built-in head: three tables in Markdown, and the norms' source."""
    head = load("head")
    tables = [mesh_table(head), distance_table(head), depth_table(head)]
    sys.stdout.writelines(f"{line}\n" for table in tables for line in [*table, ""])
    sys.stdout.write(f"Norms: mean ± deviation [mm] of {WEINBERG_2016}.\n")


if __name__ == "__main__":
    main()
