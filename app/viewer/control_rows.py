"""Controls as a panel lists them: one row for a muscle and its twin on the other side."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..errors import counted
from ..mirror import TURNED, parted, twin_of

# Sides of a motion, not of the face: both at once stand still.
OPPOSITE = ("AU30", "lips_sideways", "jaw", "mouth")


@dataclass(frozen=True)
class Row:
    """One line: its label, and the controls that it has sliders for, the subject's right first."""

    label: str
    names: tuple[str, ...]


def readable(name: str) -> str:
    """A control's name in words."""
    return name.replace("_", " ")


def mirrored(values: Mapping[str, float]) -> dict[str, float]:
    """What is left becomes right; the middle turns round."""
    result = dict(values)
    for name, value in values.items():
        if twin_of(name) in values:
            result[twin_of(name)] = -value if name in TURNED else value
    return result


def change_of(before: Mapping[str, float], after: Mapping[str, float]) -> str:
    """What was set by hand, in words; what is not in `before` was 0."""
    names = sorted(name for name, value in after.items() if value != before.get(name, 0.0))
    labels = {readable(name if len(names) == 1 else parted(name)[0]) for name in names}
    if len(labels) != 1:
        return f"Set {counted(len(names), 'control')}"
    return f"Set {labels.pop()} to {after[names[0]]:.2f}"


def rows_of(names: Sequence[str], values: Mapping[str, float], *, linked: bool) -> list[Row]:
    """The rows of a group.

    linked: both sides share a slider as long as they agree. A control for both sides at once
    (AU12 beside AU12_left and AU12_right) stands for them, unless one of them is in use.
    """
    known = set(names)
    rows = []
    for name in names:
        base, side = parted(name)
        if not side:
            sides = (f"{name}_right", f"{name}_left")
            if not known.issuperset(sides):
                rows.append(Row(readable(name), (name,)))
                continue
            whole = [name] if linked or values[name] else []
            is_apart = not linked or any(values[one] for one in sides)
            rows.append(Row(readable(name), (*whole, *(sides if is_apart else ()))))
        elif base in OPPOSITE or twin_of(name) not in known:
            rows.append(Row(readable(name), (name,)))
        elif base not in known and side in ("_left", "Left"):
            rows.append(Row(readable(base), (twin_of(name), name)))
    return rows


def search_rows(
    rows: Iterable[Row], query: str, *, group: str, actions: Mapping[str, str]
) -> list[Row]:
    """The rows in which all words of the query occur: in names, group, or what a control does."""
    wanted = query.lower().split()
    return [
        row
        for row in rows
        if all(
            word
            in f"{row.label} {' '.join(row.names)} {group} {actions.get(row.names[0], '')}".lower()
            for word in wanted
        )
    ]


def highest_first(
    groups: Mapping[str, tuple[str, ...]], muscles: Collection[str], expressions: Collection[str]
) -> dict[str, tuple[str, ...]]:
    """Expressions, then the other layers above the muscles, then muscles, jaw and gaze."""

    def rank(title: str) -> int:
        """From the top, 0 first."""
        first = groups[title][0]
        return 0 if first in expressions else 1 if first not in muscles else 2

    return {title: groups[title] for title in sorted(groups, key=rank)}
