"""Pages keep their promises: links, pictures, commands, code, and the site."""

import html
import importlib
import os
import re
import shlex
import subprocess
import sys
import unicodedata
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from risorius.__main__ import command as risorius
from tests.as_installed import lay
from tests.tracked import tracked

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
TUTORIALS = ROOT / "docs" / "tutorials"
PAGES = [README, ROOT / "CONTRIBUTING.md", *tracked("docs", "*.md")]
LONG_PAGES = ("passes.md", "pyvista.md", "in_other_programs.md")  # their code runs for seconds
COMMAND = re.compile(r"(?:`|^(?:    )?(?:xvfb-run -a )?)(risorius [a-z][^`#\n]*)", re.MULTILINE)


def anchor(title):
    """A heading's fragment in links: ASCII letters, digits and hyphens, as in MkDocs."""
    plain = unicodedata.normalize("NFKD", title).encode("ascii", "ignore").decode()
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip().lower())


def blocks(page, language):
    """The fenced blocks of one language on a page, joined."""
    return "\n".join(
        re.findall(rf"^```{language}\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    """Every file and heading that a page links to exists."""
    for target in re.findall(r"(?:\]\(|src=\")([^)\s\"]+)", page.read_text(encoding="utf-8")):
        if target.startswith("http"):
            continue
        name, _, heading = target.partition("#")
        linked = (page.parent / name).resolve() if name else page
        assert linked.exists(), target
        if heading:
            titles = re.findall(r"^#+ (.*)", linked.read_text(encoding="utf-8"), re.MULTILINE)
            assert heading in [anchor(title) for title in titles], target


def test_places_in_the_paper_page_exist():
    """Every file and name that docs/the_paper_in_code.md lists exists."""
    page = (ROOT / "docs" / "the_paper_in_code.md").read_text("utf-8")
    places = re.findall(r"\| \[`([\w/.]+)(?:: (\w+))?`\]\(\.\./\1\)", page)
    assert len(places) > 20
    for file, name in places:
        code = (ROOT / file).read_text("utf-8")
        defined = rf"^ *(?:def|class) {name}\b|^{name} = " if name else ""
        assert re.search(defined, code, re.MULTILINE), (file, name)


def test_classes_and_files_of_the_architecture_exist():
    """Every class and every file or folder that docs/architecture.md names exists."""
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    sources = tracked(".", "*.py")
    code = "\n".join(path.read_text("utf-8") for path in sources)
    classes = re.findall(r"`(?:\w+\.)?([A-Z][a-z]\w+)(?:\.\w+)?`", page)
    assert len(classes) > 15
    for name in classes:
        assert re.search(rf"^ *class {name}\b", code, re.MULTILINE), name
    paths = re.findall(r"`([\w/]+(?:\.py|/))`", page)
    assert len(paths) > 40
    places = [f"/{path.relative_to(ROOT).as_posix()}" for path in sources]
    for name in paths:
        is_there = any(f"/{name}" in place for place in places)
        assert is_there, name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_are_known(page):
    """Every command on a page accepts the options shown with it."""
    for words in COMMAND.findall(page.read_text(encoding="utf-8")):
        command = risorius()
        rest = shlex.split(words)[1:]
        while isinstance(command, click.Group) and rest:
            assert rest[0] in command.commands, words
            command = command.commands[rest.pop(0)]
        options = {name for option in command.params for name in option.opts}
        for word in rest:
            if word.startswith("-"):
                assert word.partition("=")[0] in options, words


def test_pages_of_the_documentation_are_read():
    """The patterns above find the commands on the pages."""
    shown = [words for page in PAGES for words in COMMAND.findall(page.read_text("utf-8"))]
    assert len(shown) > 40
    assert any("--compare" in words for words in shown)


def test_pictures_are_few_and_small():
    """The pictures, which every clone contains, are at most 40 files and 8 MB in all."""
    pictures = tracked("docs/pictures")
    assert len(pictures) <= 40
    assert sum(path.stat().st_size for path in pictures) < 8_000_000


def test_every_picture_is_shown():
    """Every picture of the documentation is on a page; unused pictures stop the site's build."""
    texts = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    shown = {Path(target).name for target in re.findall(r"\]\(([^)\s#]+)", texts)}
    assert {path.name for path in tracked("docs/pictures")} <= shown


def test_pages_have_short_lines():
    """The README has at most 130 lines; prose, except tables and code, at most 120 columns."""
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 130
    for page in [README, ROOT / "CHANGELOG.md", *tracked("docs", "*.md")]:
        prose = re.sub(r"^```.*?^```$", "", page.read_text("utf-8"), flags=re.M | re.S)
        for line in prose.splitlines():
            is_prose = page == README or not line.startswith(("|", "    "))
            assert len(line) <= 120 or not is_prose, f"{page.name}: {line}"


def test_prose_is_not_indented():
    """No paragraph is indented by four blanks, because Markdown would show it as code."""
    for page in [README, ROOT / "CHANGELOG.md", *tracked("docs", "*.md")]:
        prose = re.sub(r"^```.*?^```$", "", page.read_text("utf-8"), flags=re.M | re.S)
        assert not re.findall(r"^ {4,}\*\*\w.*", prose, flags=re.M), page.name


@pytest.mark.usefixtures("own_refiners")
@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=pytest.mark.slow if page.name in LONG_PAGES else ())
        for page in PAGES
        if "```python" in page.read_text("utf-8")
    ],
    ids=lambda page: page.name,
)
def test_code_runs(page, tmp_path, monkeypatch):
    """The Python on a page is one program, which runs in an empty folder."""
    monkeypatch.chdir(tmp_path)
    program = blocks(page, "python")
    if "pv.Plotter" in program:  # with other OpenGL versions VTK may end the whole test process
        subprocess.run([sys.executable, "-c", program], check=True)
    else:
        exec(compile(program, page, "exec"), {"__name__": page.stem})


def test_a_page_with_code_is_found():
    """The pattern above finds pages with fenced blocks of Python."""
    assert "refiner.refine(positions)" in blocks(README, "python")
    assert "risorius replay smile.toml" in blocks(TUTORIALS / "first_film.md", "sh")


@pytest.mark.slow
def test_first_film(tmp_path, monkeypatch):
    """The tutorial's commands make the outputs that they name."""
    page = TUTORIALS / "first_film.md"
    capture_as_shown(page, {"smile.toml": blocks(page, "toml")}, tmp_path, monkeypatch)
    assert {path.name for path in tmp_path.iterdir()} == {
        *("joy.png", "wink.png", "smile.toml", "smile.mp4", "both.mp4", "looks.mp4", "splits.png")
    }


@pytest.mark.slow
def test_own_head(tmp_path, monkeypatch):
    """The tutorial's commands fit and film a head."""
    page = TUTORIALS / "own_head.md"
    monkeypatch.chdir(tmp_path)
    for program in re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), flags=re.M | re.S):
        exec(compile(program, page, "exec"), {})  # alone: other pages link to the last
    hello = (ROOT / "docs" / "hello.toml").read_text(encoding="utf-8")
    (tmp_path / "docs").mkdir()
    capture_as_shown(page, {"docs/hello.toml": hello}, tmp_path, monkeypatch)
    assert (tmp_path / "anna.png").exists()
    assert (tmp_path / "anna.mp4").exists()


def capture_as_shown(page, files, folder, monkeypatch):
    """Run every `risorius capture` of a page in a folder with these files, with small pictures."""
    monkeypatch.chdir(folder)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    commands = re.findall(r"^risorius (capture .*)$", blocks(page, "sh"), re.MULTILINE)
    assert commands
    for command in commands:
        words = [*shlex.split(command), "--size", "320x180", "--fps", "5"]
        result = CliRunner().invoke(risorius(), words, catch_exceptions=False)
        assert result.exit_code == 0, result.output


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as by `make docs`."""
    folder = tmp_path_factory.mktemp("site")
    lay(folder / "as_installed")
    environment = {
        **os.environ,
        "RISORIUS_AS_INSTALLED": str(folder / "as_installed"),
        "NO_MKDOCS_2_WARNING": "1",
    }
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", folder / "html"]
    result = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    assert not result.stderr
    return folder / "html"


@pytest.mark.slow
def test_links_to_code_lead_to_pages_of_the_site(site):
    """The site has the code of each file to which a page links, though it lies outside docs/."""
    page = (site / "the_paper_in_code" / "index.html").read_text(encoding="utf-8")
    links = set(re.findall(r'href="\.\./(code/[\w/]+)/"', page))
    assert "code/refine/kahler/table" in links
    for link in links:
        name = link.removeprefix("code/")
        shown = html.unescape((site / link / "index.html").read_text(encoding="utf-8"))
        first_line = (ROOT / f"{name}.py").read_text("utf-8").partition("\n")[0]
        assert first_line.strip('"') in re.sub(r"<[^>]+>", "", shown)


@pytest.mark.slow
@pytest.mark.parametrize("package", ["refine", "sim", "render", "assets", "app.recordings"])
def test_the_reference_has_every_public_name(site, package):
    """Every export of a package has an anchor on its page, and special methods have none."""
    name = package.rpartition(".")[2]
    page = (site / "reference" / name / "index.html").read_text(encoding="utf-8")
    places = set(re.findall(r'id="(risorius[.\w]*)"', page))
    assert not any("__" in place for place in places)
    module = importlib.import_module(f"risorius.{package}")
    # A function in a module of the same name is shown under the module.
    places |= {place.rpartition(".")[0] for place in places}
    missing = [name for name in module.__all__ if f"{module.__name__}.{name}" not in places]
    assert not missing
