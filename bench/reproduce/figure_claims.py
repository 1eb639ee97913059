"""What the paper claims of its figures 8, 9 and 10, measured on ours.

Kähler, Haber, Seidel 2003, section 5. Numbers are means over the columns or expressions of a
figure; how they are taken is told in the module that draws it.
"""

from __future__ import annotations

import numpy as np

from risorius import refine

from ..canvas import Canvas
from . import figure_8, figure_9, figure_10, folds
from .claims import Outcome
from .mouths import wrong_pixels

SIZE_9, SIZE_10 = (380, 230), (330, 250)  # [pixels] in which differences are counted
SEEN = 8.0  # levels of 255: a change that is seen


def figure_8_outcome() -> Outcome:
    """How much nearer to folds subtriangles lie, and how much thinner they are."""
    values = {}
    for pose in figure_8.POSES:
        scene = figure_8.posed(pose)
        refiner = refine.create("kahler", scene.faces, scene.rest_positions)
        before, after = folds.measure(refiner, scene.faces, scene.positions)
        values[f"{pose.scene}: degrees off the fold, refined"] = after.off_fold
        nearer = before.off_fold - after.off_fold
        values[f"{pose.scene}: degrees nearer to the fold than before"] = nearer
        thinner = after.smallest_angle / before.smallest_angle
        values[f"{pose.scene}: smallest angle, refined over static"] = thinner
    return Outcome(values, {"figure8": figure_8.draw()})


def figure_9_outcome() -> Outcome:
    """How far the shading of static and refined plane is from that of the sine."""
    values = {}
    variants = figure_9.VARIANTS[:3]
    with Canvas(SIZE_9) as canvas:
        plane = figure_9.Waving(canvas)
        for shading, style in figure_9.SHADINGS:
            off = [
                [
                    figure_9.levels_apart(
                        plane.image(variant, style, phase)[0], plane.true_image(phase)
                    )
                    for phase in figure_9.PHASES
                ]
                for variant in variants
            ]
            before, after, with_own = np.mean(off, axis=1)
            values[f"{shading}: shading error, refined over static"] = float(after / before)
            name = f"{shading}: with normals of the refined surface, over static"
            values[name] = float(with_own / before)
    return Outcome(values, {"figure9": figure_9.draw(SIZE_9)})


def figure_10_outcome() -> Outcome:
    """How much of the error of mouths goes away, by the interpolating scheme."""
    changed, left, outline = [], [], []
    blocks = figure_10.drawn(SIZE_10, figure_10.VARIANTS, figure_10.SHOTS)
    for _, cells in blocks:
        named = {cell.title: cell for cell in cells}
        static, refined, truth = named["static"], named["refined: cubic"], cells[-1]
        changed.append(100.0 * (figure_10.difference(refined, static) > SEEN).mean())
        off = [
            np.sqrt((figure_10.difference(cell, truth) ** 2).mean()) for cell in (static, refined)
        ]
        left.append(off[1] / off[0])
        wrong = [wrong_pixels(cell.kinds, truth.kinds) for cell in (static, refined)]
        outline.append(wrong[1] / wrong[0])
    values = {
        "pixels that change visibly [%]": float(np.mean(changed)),
        "difference from the dense mesh, refined over static": float(np.mean(left)),
        "wrong pixels of the opening, refined over static": float(np.mean(outline)),
    }
    return Outcome(values, {"figure10": figure_10.page(blocks)})
