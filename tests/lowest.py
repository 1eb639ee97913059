"""Print the lowest version of every dependency in pyproject.toml, as a constraints file for pip.

    python tests/lowest.py > constraints-lowest.txt

`make test-lowest` runs the tests with exactly these versions, because an untested bound is a guess.
"""

import re
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
REQUIREMENT = re.compile(r"(?P<name>[\w.-]+)>=(?P<version>[\w.]+)(?P<marker>;.*)?")


def lowest(requirements: Sequence[str]) -> list[str]:
    """Change each NAME>=VERSION (; MARKER) to NAME==VERSION; ValueError for any other form."""
    pinned = []
    for requirement in requirements:
        match = REQUIREMENT.fullmatch(requirement)
        if match is None:
            raise ValueError(f"{requirement!r} has no lowest version; write it NAME>=VERSION")
        pinned.append(f"{match['name']}=={match['version']}{match['marker'] or ''}")
    return pinned


def main() -> None:
    """Print the versions of the program and of all its extras."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    named = [*project["dependencies"], *(each for extra in extras for each in extra)]
    requirements = [each for each in named if not each.startswith(f"{project['name']}[")]
    try:
        print("\n".join(lowest(requirements)))
    except ValueError as error:
        sys.exit(f"{PROJECT.name}: {error}")


if __name__ == "__main__":
    main()
