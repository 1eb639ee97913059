"""Reads tables of files into typed records: the types of fields are the rules for a file.

A record is a frozen dataclass that is also a `Record`; its fields are the keys of a table. pydantic
checks; an error is reported in one line:

    face.toml, 'muscle', 'frontalis', 'width': was 99, must be a number from 1 to 60

This module is below every package, because it reads rigs, scripts, landmarks, recordings and
settings.
"""

from __future__ import annotations

import difflib
import json
import marshal
import reprlib
import tomllib
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache, lru_cache, partial
from typing import Annotated, Any, TypeVar, cast, get_args, get_origin, get_type_hints

from pydantic import (
    AllowInfNan,
    Field,
    GetCoreSchemaHandler,
    Strict,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, ErrorDetails, core_schema

Read = TypeVar("Read")

# pydantic's name of an error -> the allowed values.
MUST_BE = {
    "bool_type": "true or false",
    "dataclass_type": "a table",
    "dict_type": "a table",
    "finite_number": "a finite number",
    "float_type": "a number",
    "int_type": "a whole number",
    "list_type": "a list",
    "literal_error": "one of {expected}",
    "string_type": "a text",
    "too_long": "a list of {max_length}",
    "tuple_type": "a list",
}
LENIENT_NOTE = "unknown keys are ignored"  # for files of other versions
ADDED_START = "("  # readers add keys that begin with this; no file has them
REST_KEY = f"{ADDED_START}rest)"
HIDDEN_KEY = f"{ADDED_START}hidden)"


class Record:
    """A table of a file; see the head of this module. A key without a field is a mistake.

    A field of the type `Rest[...]`, of which there may be one, takes all other keys instead.
    """

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[Any], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Pydantic's check, after unknown keys were reported or moved to the `Rest` field."""
        check = partial(_known_keys_of, _keys(cls))
        return core_schema.with_info_before_validator_function(check, handler(source))


@dataclass(frozen=True)
class Within:
    """A rule for a number, or for each number of a tuple: finite, from `low` to `high`, no bool."""

    low: float
    high: float

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """The check of a number of the annotated kinds."""
        if get_origin(source) is tuple:
            schema = core_schema.tuple_schema(
                list(map(self._check_one, get_args(source))), strict=True
            )
            return core_schema.no_info_before_validator_function(
                lambda given: tuple(given) if isinstance(given, list) else given, schema
            )
        return self._check_one(source)

    def _check_one(self, source: Any) -> CoreSchema:
        limits: dict[str, Any] = {"ge": self.low, "le": self.high, "strict": True}
        is_whole = source is int
        schema = (
            core_schema.int_schema(**limits)
            if is_whole
            else core_schema.float_schema(**limits, allow_inf_nan=False)
        )
        kind = "a whole number" if is_whole else "a number"
        message = f"{kind} from {self.low:g} to {self.high:g}"
        return core_schema.custom_error_schema(schema, "must_be", custom_error_message=message)


@dataclass(frozen=True)
class OneOf:
    """A rule for a value: it must be one of `values`, or of the values that a function returns.

    description: words that replace a long list of values in an error.
    """

    allowed: Iterable[Any] | Callable[[], Iterable[Any]]
    description: str = ""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """A choice by value and type, because True is equal to 1."""
        allowed = tuple(self.allowed() if callable(self.allowed) else self.allowed)
        typed = {(type(each), each) for each in allowed}

        def one(given: Any) -> Any:
            """The given value if it is allowed; raises ValueError otherwise."""
            if not isinstance(given, Hashable) or (type(given), given) not in typed:
                raise ValueError
            return given

        return core_schema.custom_error_schema(
            core_schema.no_info_plain_validator_function(one),
            "must_be",
            custom_error_message=self.description or f"one of {', '.join(allowed)}",
        )


@dataclass(frozen=True)
class MadeFrom:
    """A rule for any type: a function converts the value in the file, or raises ValueError."""

    table: Any
    make: Callable[[Any], Any]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """The check of the table, then the function."""
        return core_schema.no_info_after_validator_function(
            self.make, handler.generate_schema(self.table)
        )


@dataclass(frozen=True)
class Kinds:
    """A record of one of several classes: the key `kind` of the table names the class."""

    records: Mapping[str, type[Record]]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """A choice by the key `kind`, which is not a field of the records."""
        return core_schema.tagged_union_schema(
            {
                ADDED_START + name: core_schema.no_info_before_validator_function(
                    lambda table: {key: table[key] for key in table if key != "kind"},
                    handler.generate_schema(record),
                )
                for name, record in self.records.items()
            },
            lambda table: (
                f"{ADDED_START}{table.get('kind')}" if isinstance(table, Mapping) else None
            ),
            custom_error_type="must_be",
            custom_error_message=f"a table whose 'kind' is one of {', '.join(self.records)}",
        )


def called(key: str) -> Any:
    """Declare that a field has the name `key` in files."""
    return Field(alias=key)


Number = Annotated[float, Strict(), AllowInfNan(False)]
Flag = Annotated[bool, Strict()]
Rest = Annotated[dict[str, Read], called(REST_KEY)]  # type of a field with all other keys
Hidden = Annotated[Read, called(HIDDEN_KEY)]  # type of a field without a key in files


_adapter: Callable[[Any], TypeAdapter[Any]] = cache(TypeAdapter)


def read(
    kind: type[Read],
    document: Any,
    where: str,
    *,
    error: type[Exception] = ValueError,
) -> Read:
    """Convert the content of a file to a record, or to a value of another type.

    where: the file, or the part of it, for error messages.

    Raises `error`, whose line has `where`, the value, and the allowed values.
    """
    try:
        return cast(Read, _adapter(kind).validate_python(document))
    except ValidationError as problem:
        raise error(_line(where, problem.errors(include_url=False)[0])) from None


def read_once(kind: type[Read], document: Any, where: str) -> Read:
    """Return what `read` returns; equal documents share one record, which nobody may change.

    Persons share tables, which take milliseconds to check.
    """
    try:
        content = marshal.dumps(document, 2)  # version 2 does not depend on counts of references
    except ValueError:  # not the plain types of files
        return read(kind, document, where)
    return cast(Read, _remembered(kind, content, where))


def _read_content(kind: type[Any], content: bytes, where: str) -> Any:
    return read(kind, marshal.loads(content), where)


_remembered: Callable[..., Any] = lru_cache(32)(_read_content)


def read_valid_entries(kind: type[Read], document: Any) -> tuple[Read, list[str]]:
    """Return a record of the allowed entries of a table, and a message for each other entry.

    It is for settings: the program must start even if the file comes from another version or was
    edited by hand. Every field has a default; an entry is a key of the table, or of a table within
    it.
    """
    found: list[str] = []
    while True:
        try:
            return cast(Read, _adapter(kind).validate_python(document, context=LENIENT_NOTE)), found
        except ValidationError as problem:
            first = problem.errors(include_url=False)[0]
            found.append(_line("", first).removeprefix(": "))
            document = _without_entry(document, first["loc"])


def quoted(value: object) -> str:
    """A value in the text of an error, shortened if it is long."""
    try:
        return reprlib.repr(value)
    except ValueError:  # Python does not write numbers with thousands of digits
        return f"a very long {type(value).__name__}"


def question(name: str, known: Iterable[str]) -> str:
    """The nearest known name, as a question at the end of an error; "" if none is near."""
    near = difflib.get_close_matches(str(name), list(known), n=1)
    return f"; did you mean '{near[0]}'?" if near else ""


def parsed_toml(text: str) -> dict[str, Any]:
    """The table of a TOML file; raises ValueError with the reason for another text."""
    return cast(dict[str, Any], _parsed(tomllib.loads, text, "TOML"))


def parsed_json(text: str | bytes) -> Any:
    """The content of a JSON file; raises ValueError with the reason for another text."""
    return _parsed(json.loads, text, "JSON")


def _parsed(loads: Callable[[Any], Any], text: str | bytes, language: str) -> Any:
    try:
        return loads(text)
    except RecursionError:
        reason = "brackets are nested too deep"
    except ValueError as error:
        is_long = "set_int_max_str_digits" in str(error)  # advice for programmers
        reason = "a number has thousands of digits" if is_long else str(error)
    raise ValueError(f"not valid {language}: {reason}")


def _keys(record: type[Any]) -> tuple[str, ...]:
    """The names of a record's fields in files."""
    hints = get_type_hints(record, include_extras=True)
    names = []
    for each in fields(record):
        marks = getattr(hints[each.name], "__metadata__", ())
        aliases = [mark.alias for mark in marks if isinstance(mark, FieldInfo)]
        names.append(next(filter(None, aliases), each.name))
    return tuple(names)


def _known_keys_of(known: tuple[str, ...], table: Any, info: ValidationInfo) -> Any:
    """Move unknown keys of a table to the `Rest` field; raises ValueError if there is none."""
    if not isinstance(table, Mapping):
        return table
    plain = [key for key in known if not key.startswith(ADDED_START)]
    found = {key: value for key, value in table.items() if key in plain}
    others = {key: value for key, value in table.items() if key not in plain}
    if REST_KEY in known:
        return {**found, REST_KEY: {str(key): value for key, value in others.items()}}
    for key in () if info.context is LENIENT_NOTE else others:
        allowed = ", ".join(each for each in known if not each.startswith(ADDED_START))
        raise ValueError(
            f"unknown key {quoted(key)}{question(key, known) or '.'} Allowed: {allowed}"
        )
    return found


def _line(where: str, problem: ErrorDetails) -> str:
    """The place of an error, the value there, and the allowed values."""
    place = where
    for key in problem["loc"]:
        if isinstance(key, int):
            place += f" {key + 1}"
        elif not key.startswith(ADDED_START) and key != "[key]":
            place += f", {quoted(key)}"
    place = place.removeprefix(", ")
    kind = problem["type"]
    context = problem.get("ctx", {})
    if kind == "missing":
        return f"{place}: is missing; it must be there"
    if kind == "value_error":
        return f"{place}: {context['error']}"
    allowed = MUST_BE[kind].format(**context) if kind in MUST_BE else problem["msg"]
    return f"{place}: was {quoted(problem['input'])}, must be {allowed}"


def _without_entry(document: Any, place: Sequence[int | str]) -> Any:
    """A table without the entry at this place, which may be in a nested table."""
    keys = [key for key in place if not str(key).startswith(ADDED_START)]
    if not isinstance(document, Mapping) or not keys or keys[0] not in document:
        return {}
    left = dict(document)
    first, *inner_keys = keys
    inner = left[first]
    if inner_keys and isinstance(inner, Mapping) and inner_keys[0] in inner:
        left[first] = _without_entry(inner, inner_keys)
    else:
        del left[first]
    return left
