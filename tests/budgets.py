"""Tokens of each room and its budget: `python tests/budgets.py`; ends with 1 if one is over.

The budgets are `[tool.risorius.budgets]` in `pyproject.toml`. A file belongs to the longest folder
that contains it, so `app` is the rest of the application. Comments, docstrings and layout do not
count: packing two statements into a line saves nothing, and a comment costs nothing.

Further columns measure how plainly each room is written:

- per line: tokens a line of code
- packed: assignments `a, b = x, y` a thousand lines of code; swaps do not count
- constants: names in capitals at the top of modules, a thousand lines of code
- told: the words "told", "tell" and "tells", for which set, given, reported or printed is plainer
- what is: free relative clauses such as "what is", "who has" or "whoever", a thousand lines

Below is the number of words in `docs/*.md`. A word has a letter or a digit: bars of tables do not
count.
"""

import ast
import io
import re
import sys
import tokenize
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

LAYOUT_TOKENS = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
}

TOLD_WORDS = re.compile(r"\b(told|tells?)\b", re.IGNORECASE)
FREE_RELATIVE = re.compile(
    r"\b(what (is|was|are|has|have|it|they|a|the)|who (is|does|has)|whatever|whoever)\b",
    re.IGNORECASE,
)


@dataclass
class Count:
    """Sums over the files of one room (a group of folders with one budget)."""

    tokens: int = 0
    lines: int = 0  # lines that hold a token of code
    text_lines: int = 0
    packed: int = 0
    constants: int = 0
    told: int = 0
    relatives: int = 0

    def add_python(self, text: str) -> None:
        """Count a module, given its text."""
        tree = ast.parse(text)
        statements = list(statements_in(tree))
        documented = docstring_lines(statements)
        tokens = [
            token
            for token in tokenize.generate_tokens(io.StringIO(text).readline)
            if token.type not in LAYOUT_TOKENS and token.start[0] not in documented
        ]
        self.tokens += len(tokens)
        lines = {line for t in tokens for line in range(t.start[0], t.end[0] + 1)}
        self.lines += len(lines)
        self.text_lines += text.count("\n")
        self.packed += sum(map(is_packed, statements))
        self.constants += sum(constants_of(node) for node in tree.body)
        self.told += len(TOLD_WORDS.findall(text))
        self.relatives += len(FREE_RELATIVE.findall(text))


def statements_in(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the statements below a node; `ast.walk` visits ten times as many expressions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.stmt | ast.excepthandler | ast.match_case):
            yield child
            yield from statements_in(child)


def docstring_lines(statements: Sequence[ast.AST]) -> set[int]:
    """Line numbers of docstrings, and of strings below attributes."""
    strings = [
        node
        for node in statements
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    ]
    return {line for node in strings for line in range(node.lineno, (node.end_lineno or 0) + 1)}


def is_packed(node: ast.AST) -> bool:
    """Whether a node is an assignment `a, b = x, y` that is not a swap."""
    if not isinstance(node, ast.Assign):
        return False
    target = node.targets[0]
    value = node.value
    if not (isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)):
        return False
    written = {ast.unparse(element) for element in target.elts}
    read = {ast.unparse(element) for element in value.elts}
    return len(target.elts) == len(value.elts) and not written & read


def constants_of(node: ast.stmt) -> int:
    """The number of names in capitals that a module's statement assigns."""
    if isinstance(node, ast.Assign):
        targets = node.targets
    elif isinstance(node, ast.AnnAssign):
        targets = [node.target]
    else:
        return 0
    names = [n for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
    return sum(name.id.isupper() for name in names)


def read_budgets() -> dict[str, int]:
    """Read each room's budget; a room is named by the paths of its folders, separated by blanks."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    rooms: dict[str, int] = settings["tool"]["risorius"]["budgets"]
    return rooms


def count_rooms(rooms: list[str]) -> dict[str, Count]:
    """Count every file of each room."""
    counts = {room: Count() for room in rooms}
    room_of = {ROOT / folder: room for room in rooms for folder in room.split()}
    for path in sorted({path for folder in room_of for path in folder.rglob("*.py")}):
        counts[find_room(path, room_of)].add_python(path.read_text("utf-8"))
    return counts


def find_room(path: Path, room_of: dict[Path, str]) -> str:
    """Find the room of the longest folder that contains a file."""
    return next(room_of[parent] for parent in path.parents if parent in room_of)


def sum_of(counts: list[Count]) -> Count:
    """Add counts of rooms."""
    names = [field.name for field in fields(Count)]
    sums = {name: sum(getattr(count, name) for count in counts) for name in names}
    return Count(**sums)


def print_row(name: str, count: Count, budget: int) -> None:
    """Print a row of the table; return whether its room is over its budget."""
    code = max(count.lines, 1)
    text = max(count.text_lines, 1)
    print(
        f"{name:23}{count.tokens:10}{budget:10}{count.tokens / code:10.1f}"
        f"{1000 * count.packed / code:10.1f}{1000 * count.constants / code:10.1f}"
        f"{count.told:10}{1000 * count.relatives / text:10.1f}"
        f"{'  OVER' if count.tokens > budget else ''}"
    )


def main() -> int:
    """Print the table; return 1 if a room has more tokens than its budget."""
    budgets = read_budgets()
    counts = count_rooms(list(budgets))
    heads = ["tokens", "budget", "per line", "packed", "constants", "told", "what is"]
    print(f"{'':23}" + "".join(f"{head:>10}" for head in heads))
    for room, count in counts.items():
        print_row(room, count, budgets[room])
    outside = [count for room, count in counts.items() if room != "tests"]
    budget = sum(budget for room, budget in budgets.items() if room != "tests")
    print_row("all outside tests", sum_of(outside), budget)
    pages = [path.read_text("utf-8") for path in (ROOT / "docs").glob("*.md")]
    words = [word for page in pages for word in page.split() if re.search(r"\w", word)]
    print(f"words of docs/*.md: {len(words)}")
    return int(any(count.tokens > budgets[room] for room, count in counts.items()))


if __name__ == "__main__":
    sys.exit(main())
