"""Mesh report of the built-in head, printed by `python -m risorius.assets.report`.

Distances are measured between vertices, straight, with the names of anthropometry. Beside them
stand the published means of adults, where there are such (`norms`), and how many deviations the
head lies above or below them. The head is nobody, and of no sex: it is held against both.
"""

import argparse
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
from .norms import DEPTHS, NORMS, Norm, Sample
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


def report(head: Head) -> list[Row]:
    """Measure a head: surface, triangles, face."""
    return [*topology_rows(head), *quality_rows(head), *distance_rows(head)]


def line(row: Row) -> str:
    """One line of text: the value, and means, deviations and scores where there is a norm."""
    text = f"{row.title:40s} {row.value:10.2f} {row.unit}"
    if row.norm is None:
        return text

    def beside(sample: Sample) -> str:
        """Mean, deviation and score."""
        mean = f"{sample.mean:6.1f} +- {sample.deviation:.1f}"
        return f"{mean:>15s} {sample.score(row.value):+5.1f}"

    usual_for = row.norm.usual_for(row.value)
    return f"{text:54s} {beside(row.norm.women)}   {beside(row.norm.men)}   {usual_for}"


def text_lines(rows: list[Row]) -> list[str]:
    """The whole report as lines of text, sources last."""
    heading = f"{'':55s} {'women':>13s} {'score':>7s}   {'men':>13s} {'score':>7s}   usual for"
    first = next((i for i, row in enumerate(rows) if row.norm is not None), len(rows))
    lines = [line(row) for row in rows]
    sources = sorted({row.norm.source for row in rows if row.norm is not None})
    notes = [f"Norms: mean +- deviation [mm] of {source}." for source in sources]
    return [*lines[:first], heading, *lines[first:], *notes]


def table(rows: list[Row]) -> list[str]:
    """The distances as a table in Markdown."""
    lines = [
        "| measure | ours | women | score | men | score | usual for |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        cells = [row.title, f"{row.value:.1f}"]
        if row.norm is None:
            cells += [""] * 5
        else:
            for sample in (row.norm.women, row.norm.men):
                cells.append(f"{sample.mean:.1f} ± {sample.deviation:.1f}")
                cells.append(f"{sample.score(row.value):+.1f}")
            cells.append(row.norm.usual_for(row.value))
        lines.append(f"| {' | '.join(cells)} |".replace("|  |", "| |").replace("|  |", "| |"))
    return lines


def depth_table(head: Head) -> list[str]:
    """How deep bone lies below named points as a table in Markdown, with what was published."""
    lines = ["| bone below | ours | published | score | measured on |", "|---|---|---|---|---|"]
    for name in DEPTH_NAMES:
        ours = float(head.bone_depth[head.anatomy[name]])
        cells = [name.removesuffix("_left").replace("_", " "), f"{ours:.1f}"]
        text = f"| {' | '.join(cells)} | | | |"
        if name in DEPTHS:
            sample, source = DEPTHS[name]
            text = " | ".join(
                [
                    f"| {' | '.join(cells)}",
                    f"{sample.mean:.1f} ± {sample.deviation:.1f}",
                    f"{sample.score(ours):+.1f}",
                    f"{source} |",
                ]
            )
        lines.append(text)
    return lines


def main(arguments: list[str]) -> None:
    """Write the report of the built-in head, or only its distances and depths as tables."""
    parser = argparse.ArgumentParser(
        prog="python -m risorius.assets.report", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--table", action="store_true", help="both tables only, in Markdown")
    head = load("head")
    is_table = parser.parse_args(arguments).table
    lines = table(distance_rows(head)) if is_table else text_lines(report(head))
    sys.stdout.writelines(f"{text}\n" for text in [*lines, "", *depth_table(head)])


if __name__ == "__main__":
    main(sys.argv[1:])
