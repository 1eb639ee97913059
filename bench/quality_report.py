"""What `risorius bench quality` prints and draws: errors of refined meshes, and the targets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from risorius.app.files import Image

from .charts import Axis, Series, chart
from .quality import (
    COARSE,
    EVERYWHERE,
    IDEAL,
    RULES,
    SCHEMES,
    UNIFORM,
    Key,
    Score,
    means,
)
from .report import table, verdict
from .subjects import Subject

ADAPTIVE = {"loop": 1.6, "cubic": 1.6, "detail": 2.0}
"""The budget of each scheme in the table: what the targets speak of."""
ASKED = {"cubic": (10, 35), "detail": (40, 75)}
"""Per cent by which a scheme is to be better than the coarse mesh: adaptive, everything twice."""
NORMALS_ASKED = 30
"""Per cent by which the normals of `detail` are to be better."""
ROUNDING = 5e-4
"""A share of the coarse error up to which two errors are equal."""


COLUMNS: tuple[tuple[tuple[str, str], Key], ...] = (
    (("", "coarse"), (COARSE, "", 1.0)),
    (("drop", "loop 1.6x"), ("loop", "drop", 1.6)),
    (("drop", "cubic 1.6x"), ("cubic", "drop", 1.6)),
    (("bulge", "cubic 1.6x"), ("cubic", "bulge", 1.6)),
    (("bulge", "detail 2x"), ("detail", "bulge", 2.0)),
    *((("all twice", method), (method, "", EVERYWHERE)) for method in SCHEMES),
    (("uniform", "Loop 4x"), (UNIFORM[0], "", 1.0)),
    (("uniform", "Loop 16x"), (UNIFORM[0], "", 2.0)),
    (("uniform", "PN 4x"), (UNIFORM[1], "", 1.0)),
    (("uniform", "PN 16x"), (UNIFORM[1], "", 2.0)),
)
"""Two lines of head, and what stands below them."""


def text(subject: Subject, scores: Sequence[Score]) -> str:
    """All that is printed of a subject."""
    parts = [errors_table(scores), rules_table(scores), targets_text(scores)]
    return "\n\n".join([f"{_title(subject)}\n{parts[0]}", *parts[1:]])


def _title(subject: Subject) -> str:
    return (
        f"{subject.name}: {len(subject.coarse_faces)} triangles against {len(subject.dense_faces)}"
    )


def errors_table(scores: Sequence[Score]) -> str:
    """Errors of every expression, for adaptive refinement and for everything split twice."""
    average = means(scores)
    columns = [(head, key) for head, key in COLUMNS if key in average]
    by_key = {(*s.key, s.expression): s for s in scores}
    expressions = list(dict.fromkeys(s.expression for s in scores))
    widths = [max(7, *map(len, head)) for head, _ in columns]
    lines: list[str] = []
    for what, unit, digits in (
        ("distance", "RMS distance [mm]", 3),
        ("angle", "RMS angle of normals [deg]", 2),
    ):
        for row, name in enumerate(("", unit)):
            heads = [f"{head[row]:>{w}}" for (head, _), w in zip(columns, widths, strict=True)]
            lines.append(f"{name:26} {' '.join(heads)}".rstrip())
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


def rules_table(scores: Sequence[Score]) -> str:
    """Means over expressions of every scheme with every rule that splits edges."""
    average = means(scores)
    coarse = average[COARSE, "", 1.0]
    columns = ("mean over expressions:<26", "x triangles:11.2f", "mm:7.3f", "better:>8",
        "degrees:8.2f", "better:>8", "median:7.2f", "better:>8")  # fmt: skip
    rows = []
    for (method, rule, budget), found in average.items():
        how = "twice" if budget == EVERYWHERE else rule
        cells = [f"{method}, {how}" if how else method, found.triangles / coarse.triangles]
        for what in ("distance", "angle", "median_angle"):
            error = getattr(found, what)
            cells += [error, f"{100.0 * (1.0 - error / getattr(coarse, what)):.1f} %"]
        rows.append(cells)
    return "\n".join(table(columns, rows))


def targets_text(scores: Sequence[Score]) -> str:
    """What was aimed at, what was found, and whether it is met."""
    lines = ["Targets, means over expressions; better = less error than the coarse mesh:"]
    average = means(scores)
    coarse = average[COARSE, "", 1.0]

    def better(key: Key, what: str = "distance") -> float:
        return 100.0 * (1.0 - float(getattr(average[key], what) / getattr(coarse, what)))

    def judge(scheme: str, keys: Sequence[Key], asked: int, what: str = "distance") -> None:
        """One line for the best of several ways."""
        keys = [key for key in keys if key in average]
        if not keys:
            return
        best = max(keys, key=lambda key: better(key, what))
        spent = average[best].triangles / coarse.triangles
        how = f"by {best[1]}" if best[1] else "everything twice"
        ideal = (IDEAL, *best[1:])
        extra = ""
        if scheme == "detail" and ideal in average:
            extra = f"; with its points on the truth {better(ideal, what):.1f} %"
        if what == "angle":
            extra = f", median {better(best, 'median_angle'):.1f} %{extra}"
        text = (
            f"{scheme}: {'normals ' if what == 'angle' else ''}{asked} % better; found "
            f"{better(best, what):.1f} % ({how}, {spent:.2f}x the triangles){extra}"
        )
        lines.append(verdict(better(best, what) >= asked, text))

    for scheme, (adaptive, everything) in ASKED.items():
        if not any(s.method == scheme for s in scores):
            continue
        worst, where = _worst_ratio(scores, scheme)
        text = f"{scheme}: never worse than coarse; worst {worst:.4f} of it ({where})"
        lines.append(verdict(worst <= 1.0 + ROUNDING, text))
        judge(scheme, [(scheme, rule, ADAPTIVE[scheme]) for rule in RULES], adaptive)
        judge(scheme, [(scheme, "", EVERYWHERE)], everything)
    judge(
        "detail", [("detail", rule, ADAPTIVE["detail"]) for rule in RULES], NORMALS_ASKED, "angle"
    )
    judge("detail", [("detail", "", EVERYWHERE)], NORMALS_ASKED, "angle")
    return "\n".join(lines)


def _worst_ratio(scores: Iterable[Score], scheme: str) -> tuple[float, str]:
    """The largest error over the coarse mesh's, of all expressions, rules and budgets."""
    coarse = {s.expression: s.distance for s in scores if s.method == COARSE}
    return max(
        (s.distance / coarse[s.expression], f"{s.expression}, {s.triangles} triangles")
        for s in scores
        if s.method == scheme
    )


def error_curves(
    subject: Subject, scores: Sequence[Score], chosen: str, size: tuple[int, int] = (720, 440)
) -> Image:
    """Mean distance over triangles spent, split by one rule, beside uniform subdivision."""
    average = means(scores)
    coarse = average[COARSE, "", 1.0]
    series = []
    for method in (*SCHEMES, IDEAL, *UNIFORM):
        found = sorted(
            (score.triangles / coarse.triangles, score.distance)
            for (name, rule, _), score in average.items()
            if name == method and rule in (chosen, "")
        )
        if found:
            series.append(Series(method, [(1.0, coarse.distance), *found]))
    high = 1.08 * max(y for one in series for _, y in one.points)
    step = next(step for step in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 5.0) if high / step <= 9)
    ticks = [k * step for k in range(int(high / step) + 1)]
    return chart(
        f"{_title(subject)}, split by {chosen}",
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
