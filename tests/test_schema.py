"""Tables of files become typed records, or one line says what is wrong with them."""

from dataclasses import dataclass, field
from typing import Annotated, Any

import pytest

from risorius.schema import (
    Flag,
    Hidden,
    Kinds,
    MadeFrom,
    OneOf,
    Record,
    Rest,
    Within,
    called,
    parsed_json,
    parsed_toml,
    read,
    read_what_fits,
)


@dataclass(frozen=True)
class Circle(Record):
    """A shape of one kind."""

    radius: Annotated[float, Within(0.0, 9.0)]
    name: Hidden[str] = field(default="", kw_only=True)


@dataclass(frozen=True)
class Drawing(Record):
    """A record with a field of every sort."""

    size: Annotated[tuple[int, int], Within(1, 100)] = (10, 10)
    colour: Annotated[str, OneOf(("red", "blue"))] = "red"
    is_open: Flag = False
    length: Annotated[int, MadeFrom(str, len)] = 0
    shapes: Annotated[list[Annotated[Any, Kinds({"circle": Circle})]], called("shape")] = field(
        default_factory=list
    )
    place: dict[str, Annotated[float, Within(-1.0, 1.0)]] = field(default_factory=dict)


@dataclass(frozen=True)
class Shares(Record):
    """A record that takes any other key."""

    others: Rest[Annotated[float, Within(0.0, 1.0)]]
    title: str = ""


def test_a_table_becomes_a_record() -> None:
    """Numbers, words, lists, tables of a kind and made values arrive; the rest has its default."""
    table = {"size": [3, 4], "length": "four", "shape": [{"kind": "circle", "radius": 2}]}
    assert read(Drawing, table, "d") == Drawing((3, 4), length=4, shapes=[Circle(2.0)])
    assert read(Shares, {"a": 1, "title": "T", "(rest)": 0}, "s") == Shares(
        {"a": 1.0, "(rest)": 0.0}, "T"
    )


@pytest.mark.parametrize(
    ("table", "line"),
    [
        (3, r"^d\.toml: was 3, must be a table$"),
        ({"size": [1, 101]}, r"'size' 2: was 101, must be a whole number from 1 to 100$"),
        ({"size": [1, True]}, r"'size' 2: was True, must be a whole number"),
        ({"size": [1]}, r"'size' 2: is missing; it must be there$"),
        ({"size": [1, 2, 3]}, r"'size': was .1, 2, 3., must be a list of 2$"),
        ({"colour": "rot"}, r"'colour': was 'rot', must be one of red, blue$"),
        ({"is_open": 1}, r"'is_open': was 1, must be true or false$"),
        ({"length": 7}, r"'length': was 7, must be a text$"),
        ({"shape": [{"kind": "cube"}]}, r"'shape' 1: .* 'kind' is one of circle$"),
        ({"shape": [{"kind": "circle"}]}, r"'shape' 1, 'radius': is missing"),
        (
            {"shape": [{"kind": "circle", "radius": 1, "name": "c"}]},
            r"'shape' 1: unknown key 'name'\. Allowed: radius$",
        ),
        ({"place": {"x": float("nan")}}, r"^d\.toml, 'place', 'x': was nan, must be a number"),
        ({"colur": "red"}, r"^d\.toml: unknown key 'colur'; did you mean 'colour'\? Allowed: size"),
    ],
)
def test_one_line_names_what_is_wrong(table: Any, line: str) -> None:
    """File, place, what it was and what is allowed."""
    with pytest.raises(LookupError, match=line):
        read(Drawing, table, "d.toml", error=LookupError)


def test_what_fits_is_taken() -> None:
    """Of remembered settings one wrong entry costs nothing but itself; unknown ones are no news."""
    table = {"colour": "rot", "size": [3, 4], "new": 1, "place": {"x": 2, "y": 0.5}}
    record, lines = read_what_fits(Drawing, table)
    assert record == Drawing((3, 4), place={"y": 0.5})
    assert len(lines) == 2 and lines[0].startswith("'colour': was 'rot'")
    assert read_what_fits(Drawing, [1]) == (Drawing(), ["was [1], must be a table"])


@pytest.mark.parametrize(
    ("text", "reason"),
    [("[" * 100_000, "nested too deep"), ("1" * 5000, "thousands of digits"), ("{", "line 1")],
)
def test_what_is_no_json_is_told(text: str, reason: str) -> None:
    """The reason is one for users, whatever the parser ran into."""
    with pytest.raises(ValueError, match=f"not valid JSON: .*{reason}"):
        parsed_json(text)
    with pytest.raises(ValueError, match="not valid TOML"):
        parsed_toml(f"a = {text}")
