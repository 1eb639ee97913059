"""What `risorius bench quality` prints: errors of refined meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..report import Target, at_least, at_most, table
from ..subjects import Subject
from .methods import AS_SET, EVERYWHERE, STATIC, Key
from .quality import Score, means

STATIC_KEY: Key = (STATIC, "", 1.0)
LEAST_GAIN, MOST_JUMP = 20.0, 1.5  # [%] of the error of static; times the input's motion
LEGEND = """\
better, worst  than static: per cent of error less, in the mean; largest share of it, of all
levels         RMS of grey levels beside pictures of the dense mesh, three views, 480 x 480 pixels
outline        pixels covered by one mesh and not by the other, of one view
jump           largest motion of the surface in a frame over the input's"""


def text(subject: Subject, scores: Sequence[Score]) -> str:
    """All that is printed of one subject, or of those of its group together."""
    title = (
        f"{subject.group}: {len(subject.coarse_faces)} triangles against {len(subject.dense_faces)}"
    )
    return "\n".join([title, *methods_table(scores)])


def methods_table(scores: Sequence[Score]) -> list[str]:
    """Means over expressions of all methods; the largest of jumps and of `worst`."""
    average = means(scores)
    static = average[STATIC_KEY]
    columns = (
        "mean over expressions:<24|x tri:5.2f|mm:6.3f|better:>6|worst:5.2f|degrees:7.2f|better:>6"
        "|levels:6.2f|better:>6|worst:5.2f|outline:7.0f|jump:>5"
    )
    rows = []
    for key, found in average.items():
        cells: list[object] = [_name(key), found.triangles / static.triangles]
        for what in ("distance", "angle", "picture"):
            error = getattr(found, what)
            cells += [error, f"{100.0 * (1.0 - error / getattr(static, what)):.1f}%"]
            if what != "angle":
                cells.append(worst(scores, key, what))
        jump = f"{found.jump:{'.2f' if found.jump < 10.0 else '.0f'}}"
        rows.append([*cells, found.outline, "-" if np.isnan(found.jump) else jump])
    return table(columns, rows)


def _name(key: Key) -> str:
    method, rule, budget = key
    how = {EVERYWHERE: "twice", AS_SET: "as set"}.get(budget, f"{budget:g}x")
    return " ".join(
        [method, rule, how] if rule else [method, how] if method != STATIC else [method]
    )


def worst(scores: Sequence[Score], key: Key, what: str) -> float:
    """The largest error of a method over the unrefined mesh's."""
    errors: dict[Key, dict[str, float]] = {}
    for score in scores:
        errors.setdefault(score.key, {})[score.expression] = getattr(score, what)
    static = errors[STATIC_KEY]
    return max(error / max(static[name], 1e-300) for name, error in errors[key].items())


def targets(group: str, scores: Sequence[Score]) -> list[Target]:
    """What the scheme `cubic` is held to where `displacement` splits, at twice the triangles."""
    average = means(scores)
    static = average[STATIC_KEY]
    best, calm = (average["cubic", f"displacement{how}", 2.0] for how in ("", ", blended"))
    return [
        *(
            at_least(
                f"{group}: {what} less than static",
                100.0 * (1.0 - getattr(best, what) / getattr(static, what)), LEAST_GAIN, " %",
            )
            for what in ("distance", "picture")
        ),
        at_most(f"{group}: largest jump, blended", calm.jump, MOST_JUMP),
    ]  # fmt: skip
