"""Lines of each room beside its budget: `python tests/budgets.py`; ends with 1 where one is over.

The budgets are `[tool.risorius.budgets]` in `pyproject.toml`. A file belongs to the longest folder
that it lies in, so that `app` is the rest of the application. Every line of Python counts, blank
ones and comments too; of `refine_gl`, which is small because its work is done in shaders, theirs.
"""

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def budgets() -> dict[str, int]:
    """Of each room, by the paths of its folders, separated by blanks."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    rooms: dict[str, int] = settings["tool"]["risorius"]["budgets"]
    return rooms


def lines() -> dict[str, int]:
    """How many lines each room has."""
    counts = dict.fromkeys(budgets(), 0)
    room_of = {ROOT / folder: room for room in counts for folder in room.split()}
    files = {path for folder in room_of for path in folder.rglob("*.py")}
    for path in files | set((ROOT / "refine_gl").rglob("*.glsl")):
        room = next(room_of[parent] for parent in path.parents if parent in room_of)
        counts[room] += len(path.read_text("utf-8").splitlines())
    return counts


def main() -> int:
    """Print the table; 1 where a room has more lines than its budget."""
    allowed, counted = budgets(), lines()
    for room, count in counted.items():
        print(f"{room:34}{count:7}{allowed[room]:7}{'  OVER' if count > allowed[room] else ''}")
    sums = (sum(room.values()) - room["tests"] for room in (counted, allowed))
    print(f"{'all outside tests':34}{next(sums):7}{next(sums):7}")
    return int(any(count > allowed[room] for room, count in counted.items()))


if __name__ == "__main__":
    sys.exit(main())
