"""What `risorius bench quality` prints and draws: errors of refined meshes, and the targets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bench.quality import (
    COARSE,
    CRITERIA,
    EVERYWHERE,
    IDEAL,
    SCHEMES,
    UNIFORM,
    Key,
    Score,
    means,
)

from .charts import Axis, Series, chart
from .outputs import Frame

ADAPTIVE = {"loop": 1.6, "butterfly": 1.6, "cubic": 1.6, "detail": 2.0}
"""The budget of each scheme in the table: what the targets speak of."""
ASKED = {"butterfly": (10, 35), "cubic": (10, 35), "detail": (40, 75)}
"""Per cent by which a scheme is to be better than the coarse mesh: adaptive, everything twice."""
NORMALS_ASKED = 30
"""Per cent by which the normals of `detail` are to be better."""
ROUNDING = 5e-4
"""A share of the coarse error up to which two errors are equal."""


def quality_table(title: str, scores: Sequence[Score]) -> str:
    """Errors of every expression for adaptive refinement and for everything split twice."""
    average = means(scores)
    columns = [(head, key) for head, key in _columns() if key in average]
    by_key = {(*s.key, s.expression): s for s in scores}
    expressions = list(dict.fromkeys(s.expression for s in scores))
    widths = [max(7, *map(len, head)) for head, _ in columns]
    lines = [title]
    for what, unit, digits in (
        ("distance", "RMS distance [mm]", 3),
        ("angle", "RMS angle of normals [deg]", 2),
    ):
        for row, name in enumerate(("", unit)):
            heads = [f"{head[row]:>{w}}" for (head, _), w in zip(columns, widths, strict=True)]
            lines.append(f"{name:26} {' '.join(heads)}")
        for expression in [*expressions, "mean"]:
            cells = []
            for (_, key), width in zip(columns, widths, strict=True):
                found = average[key] if expression == "mean" else by_key[(*key, expression)]
                cells.append(f"{getattr(found, what):{width}.{digits}f}")
            lines.append(f"{expression:26} {' '.join(cells)}")
        lines.append("")
    counts = [f"{average[key].triangles:{w}d}" for (_, key), w in zip(columns, widths, strict=True)]
    lines.append(f"{'triangles, mean':26} {' '.join(counts)}")
    return "\n".join(lines)


def _columns() -> list[tuple[tuple[str, str], Key]]:
    """Two lines of head and the key of each column."""
    columns: list[tuple[tuple[str, str], Key]] = [(("", "coarse"), (COARSE, "", 1.0))]
    for criterion in CRITERIA:
        for method in (*SCHEMES, IDEAL):
            budget = ADAPTIVE.get(method, ADAPTIVE["detail"])
            columns.append(((criterion, f"{method} {budget:g}x"), (method, criterion, budget)))
    columns += [(("all", method), (method, "", EVERYWHERE)) for method in (*SCHEMES, IDEAL)]
    for name in UNIFORM:
        columns += [(("uniform", f"{name[8:]} {4**n}x"), (name, "", n)) for n in (1, 2)]
    return columns


def targets_text(scores: Sequence[Score]) -> str:
    """What was aimed at, what was found, and whether it is met."""
    lines = ["Targets, means over expressions; better = less error than the coarse mesh:"]
    average = means(scores)
    coarse = average[COARSE, "", 1.0]

    def judge(key: Key, asked: int, what: str = "distance") -> None:
        if key not in average:
            return
        found = average[key]
        better = 100.0 * (1.0 - getattr(found, what) / getattr(coarse, what))
        by = f"by {key[1]}, " if key[1] else "everything twice, "
        text = f"{key[0]}: {'normals ' if what == 'angle' else ''}{asked} % better; found "
        text += f"{better:.1f} % ({by}{found.triangles / coarse.triangles:.2f}x the triangles)"
        ideal = average.get((IDEAL, *key[1:]))
        if key[0] == "detail" and what == "distance" and ideal is not None:
            most = 100.0 * (1.0 - ideal.distance / coarse.distance)
            text += f"; with all points on the truth {most:.1f} %"
        lines.append(f"  {'met   ' if better >= asked else 'MISSED'}  {text}")

    for scheme, (adaptive, everything) in ASKED.items():
        if any(s.method == scheme for s in scores):
            worst, where = _worst_ratio(scores, scheme)
            verdict = "met   " if worst <= 1.0 + ROUNDING else "MISSED"
            lines.append(
                f"  {verdict}  {scheme}: never worse than coarse; worst {worst:.4f} of it ({where})"
            )
        for criterion in CRITERIA:
            judge((scheme, criterion, ADAPTIVE[scheme]), adaptive)
        judge((scheme, "", EVERYWHERE), everything)
    for criterion in CRITERIA:
        judge(("detail", criterion, ADAPTIVE["detail"]), NORMALS_ASKED, "angle")
    judge(("detail", "", EVERYWHERE), NORMALS_ASKED, "angle")
    return "\n".join(lines)


def _worst_ratio(scores: Iterable[Score], scheme: str) -> tuple[float, str]:
    """The largest error over the coarse mesh's, of all expressions, criteria and budgets."""
    coarse = {s.expression: s.distance for s in scores if s.method == COARSE}
    return max(
        (s.distance / coarse[s.expression], f"{s.expression}, {s.triangles} triangles")
        for s in scores
        if s.method == scheme
    )


def error_curves(
    title: str, scores: Sequence[Score], chosen: str, size: tuple[int, int] = (720, 440)
) -> Frame:
    """Mean distance over triangles spent, split by a criterion, beside uniform subdivision."""
    average = means(scores)
    coarse = average[COARSE, "", 1.0]
    series = []
    for method in (*SCHEMES, IDEAL, *UNIFORM):
        found = sorted(
            (score.triangles / coarse.triangles, score.distance)
            for (name, criterion, _), score in average.items()
            if name == method and criterion in (chosen, "")
        )
        if found:
            series.append(Series(method, [(1.0, coarse.distance), *found]))
    high = 1.08 * max(y for one in series for _, y in one.points)
    step = next(step for step in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 5.0) if high / step <= 9)
    ticks = [k * step for k in range(int(high / step) + 1)]
    return chart(
        title,
        Axis(
            "triangles, times those of the coarse mesh",
            1.0,
            17.0,
            (1, 1.5, 2, 3, 4, 6, 10, 16),
            True,
        ),
        Axis("RMS distance to the true surface [mm], mean", 0.0, high, ticks),
        series,
        size,
    )
