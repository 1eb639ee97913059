"""Controls as a panel lists them: one row for a muscle and its twin on the other side."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..controls.mirror import OPPOSITE, parted, twin_of
from ..controls.vocabulary import is_found, readable, title_of
from ..errors import counted


@dataclass(frozen=True)
class Row:
    """One line: what its controls are called alike, and those that it has bars for.

    names: of both sides at once before each side, the subject's right before the left. sides: what
    can be linked, () for nothing; with is_linked the left one's bar moves both. whole: what stands
    for both sides.
    """

    label: str
    names: tuple[str, ...]
    sides: tuple[str, ...] = ()
    whole: str = ""
    is_linked: bool = False

    @classmethod
    def of_sides(
        cls,
        label: str,
        sides: tuple[str, str],
        whole: str,
        values: Mapping[str, float],
        linked: bool,
    ) -> Row:
        """A row for both sides: one bar where they are linked and agree."""
        is_linked = linked and values[sides[0]] == values[sides[1]]
        apart = sides if not is_linked else sides[1:] if values[sides[1]] or not whole else ()
        first = (whole,) if whole and not apart else ()
        return cls(label, (*first, *apart), sides, whole, is_linked)


def change_of(before: Mapping[str, float], after: Mapping[str, float]) -> str:
    """What was set by hand, in words; what is not in `before` was 0."""
    names = sorted(name for name, value in after.items() if value != before.get(name, 0.0))
    labels = {name if len(names) == 1 else parted(name)[0] for name in names}
    if len(labels) != 1:
        return f"Set {counted(len(names), 'control')}"
    return f"Set {labels.pop().replace('_', ' ')} to {after[names[0]]:.2f}"


def rows_of(
    names: Sequence[str], values: Mapping[str, float], *, linked: bool, apart: Collection[str] = ()
) -> list[Row]:
    """The rows of a group.

    linked: both sides share a bar as long as they agree, but for the rows called `apart`. A control
    for both sides at once (AU12 beside AU12_left and AU12_right) stands for them, unless one of
    them is in use.
    """
    known = set(names)
    rows = []
    for name in names:
        base, side = parted(name)
        twin = twin_of(name)
        if not side:
            sides = (f"{name}_right", f"{name}_left")
            if parted(twin)[0] == name != twin:  # of one side by itself, as a wink
                rows.append(Row(name, (twin, name)))
            elif not known.issuperset(sides):
                rows.append(Row(name, (name,)))
            else:
                joined = linked and name not in apart
                rows.append(Row.of_sides(name, sides, name, values, joined))
        elif base in OPPOSITE or twin not in known:
            rows.append(Row(name, (name,)))
        elif base not in known and side in ("_left", "Left"):
            whole = base if values.get(base) else ""  # of no group; by a pad or a script
            joined = linked and base not in apart
            rows.append(Row.of_sides(base, (twin, name), whole, values, joined))
    return rows


def search_rows(
    rows: Iterable[Row], query: str, *, group: str, actions: Mapping[str, str]
) -> list[Row]:
    """The rows in which all words of the query occur.

    In names, group, what a control does, or among other words for it.
    """
    return [row for row in rows if is_found(query, _text_of(row, group, actions), row.names)]


def _text_of(row: Row, group: str, actions: Mapping[str, str]) -> str:
    action = actions.get(row.names[-1], "")
    names = " ".join((row.label, *row.names, *row.sides))
    return " ".join((names, readable(names), *title_of(row.label, action), group, action))
