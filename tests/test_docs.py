"""What the pages promise to a reader is there: links, pictures, commands and their options."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import click
import pytest

from risorius.__main__ import command as risorius

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
COMMAND = re.compile(r"(?:`|^    (?:xvfb-run -a )?)(risorius [a-z][^`#\n]*)", re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    """Every file and heading that a page links to exists."""
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if target.startswith("http"):
            continue
        name, _, heading = target.partition("#")
        linked = (page.parent / name).resolve() if name else page
        assert linked.exists(), target
        if heading:
            titles = re.findall(r"^#+ (.*)", linked.read_text(encoding="utf-8"), re.MULTILINE)
            assert heading in [title.lower().replace(" ", "-") for title in titles], target


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_are_known(page: Path) -> None:
    """Every command that a page shows has the options that it is shown with."""
    for words in COMMAND.findall(page.read_text(encoding="utf-8")):
        command: click.Command = risorius()
        rest = shlex.split(words)[1:]
        while isinstance(command, click.Group) and rest:
            assert rest[0] in command.commands, words
            command = command.commands[rest.pop(0)]
        options = {name for option in command.params for name in option.opts}
        for word in rest:
            if word.startswith("-"):
                assert word.partition("=")[0] in options, words


def test_pages_of_the_documentation_are_read() -> None:
    """The patterns above find what they look for."""
    shown = [words for page in PAGES for words in COMMAND.findall(page.read_text("utf-8"))]
    assert len(shown) > 40
    assert any("--compare" in words for words in shown)


def test_every_page_and_picture_is_linked() -> None:
    """No page and no picture of the documentation is forgotten."""
    texts = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    linked = {Path(target).name for target in re.findall(r"\]\(([^)\s#]+)", texts)}
    pages_and_pictures = [*(ROOT / "docs").glob("*.md"), *(ROOT / "docs/pictures").iterdir()]
    assert {path.name for path in pages_and_pictures} <= linked


def test_the_citation_is_of_this_version() -> None:
    """CITATION.cff and the README cite what pyproject.toml builds."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        version = tomllib.load(file)["project"]["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"version = {{{version}}}" in (ROOT / "README.md").read_text(encoding="utf-8")
