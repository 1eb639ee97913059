"""What a script may be at most, measured in its text before anything is built from it.

A TOML parser makes a table for each part of a key and calls itself for each bracket, so that a few
kilobytes of dots could fill the memory. Lines of keys in quotes are cheap: it passes them by.
`docs/scripts.md` names these limits.
"""

from __future__ import annotations

import re

LONGEST_FILE = 2**25  # [bytes]; three quarters of an hour of capture, and /dev/zero has no end
LONGEST_BARE = 2**24  # [characters] outside of quotes and comments
DEEPEST = 8  # brackets in one another; a script needs two, and lists of lists of lists no more
MOST_PARTS = 3  # of a key with dots; a script needs two, as in [[tracks.blink]]
MOST_TABLES = 100_000  # headers but for [[pose]], and keys with dots: they take most memory by far

# Strings and comments, in which dots and brackets mean nothing. No text makes this slow: what has
# been taken is not given back, and each kind of string can be unfinished once.
_QUOTED = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+"""|' r"'''.*?'''|"
    r'"(?:[^"\\\n]|\\.)*+"|' r"'[^'\n]*+'|#[^\n]*+",
    re.DOTALL,
)  # fmt: skip
_DOTS = re.compile(r"\.[^.=,\n\[\]{}]*+")  # a dot and the part of a key behind it
_LONG_KEY = re.compile(rf"(?:{_DOTS.pattern}){{{MOST_PARTS}}}")
_HEADER = re.compile(r"^[ \t]*+\[(?!\[[ \t]*+pose[ \t]*+\]\])", re.MULTILINE)
_DOTTED = re.compile(r"(?:^|[,{])[^.=,\n\[\]{}]*+\.[^=,\n\[\]{}]*+=", re.MULTILINE)
_BRACKET = re.compile(r"[\[\]{}]")


def excess_in(text: str) -> str:
    """What is beyond these limits in the text of a script, in words with its line; "" if nothing.

    Text that is no TOML at all is left to the parser, which stops at the first mistake.
    """
    bare = _QUOTED.sub(_lines_only, text)
    if len(bare) > LONGEST_BARE:
        return f"more than {LONGEST_BARE >> 20} MB outside of quotes, where long tracks have lines"
    long_key = _LONG_KEY.search(bare)
    if long_key:
        line = _line_of(bare, long_key)
        return f"line {line}: a key has more than {MOST_PARTS} parts with dots between them"
    depth = 0
    for bracket in _BRACKET.finditer(bare):
        depth = depth + 1 if bracket[0] in "[{" else max(depth - 1, 0)
        if depth > DEEPEST:
            line = _line_of(bare, bracket)
            return f"line {line}: more than {DEEPEST} brackets are open at once"
    tables = sum(1 for _ in _HEADER.finditer(bare)) + sum(1 for _ in _DOTTED.finditer(bare))
    if tables > MOST_TABLES:
        return f"more than {MOST_TABLES} headers other than [[pose]] and keys with dots"
    return ""


def _lines_only(quoted: re.Match[str]) -> str:
    """What stands for a string: nothing that counts, in as many lines."""
    return "_" + "\n" * quoted[0].count("\n")


def _line_of(text: str, found: re.Match[str]) -> int:
    return text.count("\n", 0, found.start()) + 1
