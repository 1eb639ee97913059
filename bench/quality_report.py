"""What `risorius bench quality` prints: errors of refined meshes, and the targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .methods import AS_SET, BLENDED, EVERYWHERE, LOOK, SCHEMES, STATIC, UNIFORM, Key
from .quality import Score, means
from .report import table, verdict
from .subjects import Subject

STATIC_KEY: Key = (STATIC, "", 1.0)
PAPER = "loop"
TRAINED = "detail"
"""The scheme that is given a finer mesh."""
SPENT = 2.0
"""Triangles over those of the coarse mesh, in the targets."""
ASKED = {True: (30, 40), False: (20, 40)}
"""Per cent of picture error less than unrefined, for the head or not: without a finer mesh, with
it."""
FASTEST = 1.0
"""How far the surface may go in a frame, over the motion of the input."""
ROUNDING = 5e-4
"""A share up to which two errors are equal."""

BY_EXPRESSION: tuple[tuple[str, Key], ...] = (
    ("static", STATIC_KEY),
    ("paper 2x", (PAPER, "normal", SPENT)),
    ("look", (*LOOK, AS_SET)),
    *(
        (f"{scheme} 2x", (scheme, rules[-1], SPENT))
        for scheme, rules in SCHEMES.items()
        if scheme != PAPER
    ),
    *((f"{name} 4x", (name, "", 4.0)) for name in UNIFORM),
)
"""Titles and methods of the tables by expression; schemes are blended."""
MEASURED = (
    ("distance", "RMS distance [mm]", 3),
    ("picture", "RMS picture [grey levels]", 2),
)
"""What these tables show."""


LEGEND = """\
better, worst  than static: per cent of error less, in the mean; largest share of it, of all
levels         RMS of grey levels beside pictures of the dense mesh, three views, 480 x 480 pixels
outline        pixels covered by one mesh and not by the other, of one view
seen, toward   per cent of pixels that differ by more than 8 levels from static; of these, nearer
jump, turn     largest motion of the surface in a frame over the input's; of a normal [degrees]"""


def text(subjects: Sequence[Subject], scores: Sequence[Score]) -> str:
    """All that is printed of one subject, or of several together."""
    lines = [_title(subjects[0]), *methods_table(scores)]
    if len(subjects) == 1:
        lines += expressions_tables(scores)
    return "\n".join(lines)


def _title(subject: Subject) -> str:
    return (
        f"{subject.group}: {len(subject.coarse_faces)} triangles against {len(subject.dense_faces)}"
    )


def methods_table(scores: Sequence[Score]) -> list[str]:
    """Means over expressions of all methods; the largest of jumps, turns and `worst`."""
    average = means(scores)
    static = average[STATIC_KEY]
    columns = (
        "mean over expressions:<24|x tri:5.2f|mm:6.3f|better:>6|worst:5.2f|degrees:7.2f|better:>6"
        "|levels:6.2f|better:>6|worst:5.2f|outline:7.0f|seen %:6.1f|toward:>6|jump:>5|turn:>5"
    )
    rows = []
    for key, found in average.items():
        cells: list[object] = [_name(key), found.triangles / static.triangles]
        for what in ("distance", "angle", "picture"):
            error = getattr(found, what)
            cells += [error, f"{100.0 * (1.0 - error / getattr(static, what)):.1f}%"]
            if what != "angle":
                cells.append(worst(scores, key, what)[0])
        cells += [found.outline, found.changed]
        cells += [
            f"{value:{style}}" if value == value else "-"
            for value, style in (
                (found.toward, ".0f"),
                (found.jump, ".2f" if found.jump < 10.0 else ".0f"),
                (found.turn, ".1f"),
            )
        ]
        rows.append(cells)
    return table(columns, rows)


def _name(key: Key) -> str:
    method, rule, budget = key
    how = {EVERYWHERE: "twice", AS_SET: "as set"}.get(budget, f"{budget:g}x")
    return " ".join(
        [method, rule, how] if rule else [method, how] if method != STATIC else [method]
    )


def expressions_tables(scores: Sequence[Score]) -> list[str]:
    """Errors of every expression, for some of the methods."""
    by_key = {(*score.key, score.expression): score for score in scores}
    expressions = list(dict.fromkeys(score.expression for score in scores))
    columns = [(title, key) for title, key in BY_EXPRESSION if (*key, expressions[0]) in by_key]
    lines = []
    for what, unit, digits in MEASURED:
        titles = [f"{title}:{max(7, len(title))}.{digits}f" for title, _ in columns]
        rows = [
            [name, *(getattr(by_key[(*key, name)], what) for _, key in columns)]
            for name in expressions
        ]
        lines += ["", *table("|".join([f"{unit}:<26", *titles]), rows)]
    return lines


def worst(scores: Sequence[Score], key: Key, what: str) -> tuple[float, str]:
    """The largest error of a method over the unrefined mesh's, and in which expression."""
    static = {s.expression: getattr(s, what) for s in scores if s.key == STATIC_KEY}
    return max(
        (getattr(s, what) / max(static[s.expression], 1e-300), s.expression)
        for s in scores
        if s.key == key
    )


def targets_text(all_scores: Mapping[str, Sequence[Score]]) -> str:
    """What was aimed at, what was found, and whether it is met; `all_scores`: by group."""
    lines = [
        f"Targets, of the best blended scheme at {SPENT:g}x the triangles and of the look that the "
        "application has; better = picture error less than static:"
    ]
    for group, scores in all_scores.items():
        average = means(scores)
        for has_finer in (False, True):
            keys = [
                key
                for key in average
                if key[1].endswith(BLENDED)
                and key[0] in SCHEMES
                and key[2] == SPENT
                and (key[0] == TRAINED) == has_finer
            ]
            if keys:
                best = min(keys, key=lambda key: average[key].picture)
                asked = ASKED[group == "head"][has_finer]
                lines += _verdicts(f"{group}, {_name(best)}", scores, best, asked)
        look = *LOOK, AS_SET
        if look in average:
            lines += _verdicts(f"{group}, {_name(look)}", scores, look, None)
    return "\n".join(lines)


def _verdicts(name: str, scores: Sequence[Score], key: Key, asked: float | None) -> list[str]:
    """Targets of one method; `asked`: per cent of picture error less, if any is asked."""
    average = means(scores)
    found = average[key]
    better = 100.0 * (1.0 - found.picture / average[STATIC_KEY].picture)
    lines = []
    if asked is not None:
        lines.append(verdict(better >= asked, f"{name}: {asked} % better; found {better:.1f} %"))
    for what in ("distance", "picture"):
        ratio, where = worst(scores, key, what)
        text = f"{name}: {what} never worse than static; worst {ratio:.3f} of it ({where})"
        lines.append(verdict(ratio <= 1.0 + ROUNDING, text))
    jump, where = max((score.jump, score.expression) for score in scores if score.key == key)
    text = f"{name}: jumps at most {FASTEST:g} x the input's motion; found {jump:.2f} ({where})"
    return [*lines, verdict(jump <= FASTEST + ROUNDING, text)]
