"""The installed package: complete, equal from checkout and sdist, and usable anywhere."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest
import setuptools.glob

import risorius

from .tracked import tracked

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SETUPTOOLS = PROJECT["tool"]["setuptools"]
FOLDERS = {"risorius": "risorius", **SETUPTOOLS["package-dir"]}
TOP_NAMES = {package.partition(".")[2] for package in SETUPTOOLS["package-dir"]}
LEFTOVER_NAMES = (".#lock", "leftover.orig", "notes.rej", ".DS_Store", "Thumbs.db")
"""Files that editors and systems make in any folder."""
PAGES = {
    path.relative_to(ROOT / "docs").as_posix()
    for path in tracked("docs", "*.md")
    if "reference" not in path.parts
}
"""Pages of the installed manual."""
PASSED_OVER = shutil.ignore_patterns(
    ".git", ".venv*", ".*cache", ".hypothesis", "__pycache__", "build", "dist", "out", "*.egg-info"
)


def files_of_packages():
    """Every file of the packages, with the package of its folder."""
    for top, folder in FOLDERS.items():
        for file in tracked(folder):
            inside = file.parent.relative_to(ROOT / folder).parts
            yield ".".join((top, *inside)), file


def test_every_package_is_listed():
    """Every package folder is listed in pyproject.toml; otherwise it would not be installed."""
    found = {package for package, file in files_of_packages() if file.suffix == ".py"}
    assert sorted(SETUPTOOLS["packages"]) == sorted(found)
    assert all((ROOT / folder / "__init__.py").exists() for folder in FOLDERS.values())


def test_every_data_file_is_listed():
    """Shaders, rigs, scripts, tables and the head's data are included."""
    listed = {
        file
        for package, patterns in SETUPTOOLS["package-data"].items()
        for pattern in patterns
        for file in (ROOT / FOLDERS[package]).glob(pattern)
    }
    data = {file for _, file in files_of_packages() if file.suffix != ".py"}
    assert len(data) > 15
    assert listed & set(tracked()) == data


def test_what_an_editor_leaves_is_not_listed(tmp_path):
    """Editors' locks, copies and partial files are left out, with any suffix."""
    for package, patterns in SETUPTOOLS["package-data"].items():
        for pattern in patterns:
            folder = (tmp_path / package / pattern).parent
            folder.mkdir(parents=True, exist_ok=True)
            end = Path(pattern).suffix
            for name in (
                *LEFTOVER_NAMES,
                f".#ours{end}",
                f"ours{end}~",
                f"#ours{end}#",
                f".ours{end}.swp",
            ):
                (folder / name).touch()
            assert not setuptools.glob.glob(str(tmp_path / package / pattern)), pattern


def test_python_versions_agree():
    """Continuous integration tests every Python version that the package claims."""
    workflow = (ROOT / ".github" / "workflows" / "tests.yml").read_text(encoding="utf-8")
    (matrix,) = re.findall(r"python: (\[.*\])", workflow)
    start = "Programming Language :: Python :: 3."
    claimed = [each for each in PROJECT["project"]["classifiers"] if each.startswith(start)]
    assert [f"{start}{version.removeprefix('3.')}" for version in json.loads(matrix)] == claimed
    lowest = json.loads(matrix)[0]
    assert PROJECT["project"]["requires-python"] == f">={lowest}"
    assert PROJECT["tool"]["mypy"]["python_version"] == lowest
    assert PROJECT["tool"]["ruff"]["target-version"] == f"py{lowest.replace('.', '')}"


def test_the_release_is_the_same_everywhere():
    """Version and date agree in pyproject.toml, package, CHANGELOG.md, CITATION.cff and README."""
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## \[Unreleased\]$.*?^## \[(\S+)\] - (\S+)$", changes, re.M | re.S)
    version, date = newest.groups()
    assert version == PROJECT["project"]["version"] == risorius.__version__
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {version}\ndate-released: {date}\n" in citation
    assert f"version = {{{version}}}" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_nothing_is_imported_by_its_folder():
    """No file imports a package by its folder.

    `import render` would load `risorius.render` twice.
    """
    names = "|".join(TOP_NAMES)
    looks_so = re.compile(rf"^\s*(from\s+({names})\b|import\s.*\b({names})\b)", re.MULTILINE)
    for file in tracked(pattern="*.py"):
        source = file.read_text(encoding="utf-8")
        # Parsing all files takes seconds, so a pattern selects them first.
        for node in ast.walk(ast.parse(source)) if looks_so.search(source) else ():
            if isinstance(node, ast.Import):
                found = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level:
                found = [node.module or ""]
            else:
                continue
            bare = {name.partition(".")[0] for name in found} & TOP_NAMES
            assert not bare, f"{file}:{node.lineno}: write `from risorius import {bare.pop()}`"


@dataclass(frozen=True)
class Built:
    """Wheels of the checkout and of its sdist; an environment has the sdist's wheel installed."""

    wheels: tuple[Path, Path]
    sdist: Path
    python: Path


def run(*words, **options):
    """Run a program that must succeed, and return its output."""
    result = subprocess.run(
        [str(word) for word in words], capture_output=True, text=True, timeout=600, **options
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return str(result.stdout)


def wheel_of(folder, target):
    """Build a wheel without the network, with the setuptools of this environment."""
    run(
        sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--no-index",
        "--wheel-dir", target, folder,
    )  # fmt: skip
    (wheel,) = target.glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """The wheels, built in copies, so that no file stays in the checkout."""
    folder = tmp_path_factory.mktemp("built")
    checkout = folder / "checkout"
    shutil.copytree(ROOT, checkout, ignore=PASSED_OVER, symlinks=True)
    for inside in ("app", "assets/data", "docs/pictures", "examples", "render/shaders", "tests"):
        for name in LEFTOVER_NAMES:
            (checkout / inside / name).unlink(missing_ok=True)
            (checkout / inside / name).write_text("left by an editor")
        for name in (".#head.npz", ".#files.py"):  # a lock is a link without a target
            (checkout / inside / name).unlink(missing_ok=True)
            (checkout / inside / name).symlink_to("somebody@a.host.1234:5678")
    code = f"from setuptools import build_meta; build_meta.build_sdist({str(folder)!r})"
    run(sys.executable, "-c", code, cwd=checkout)
    (sdist,) = folder.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        archive.extractall(folder / "unpacked", filter="data")
    (unpacked,) = (folder / "unpacked").iterdir()
    wheels = wheel_of(checkout, folder / "first"), wheel_of(unpacked, folder / "second")
    run(sys.executable, "-m", "venv", "--without-pip", folder / "environment")
    python = folder / "environment" / "bin" / "python"
    site = run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip()
    # The environment finds dependencies here, but no editable installs, because Python does not
    # read the .pth files of a folder that a .pth file names.
    Path(site, "needed.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    run(sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-index",
        wheels[1])  # fmt: skip
    shutil.rmtree(checkout)
    return Built(wheels, sdist, python)


@pytest.mark.slow
def test_wheel_of_the_sdist_is_that_of_the_checkout(built):
    """Both wheels have the same name and files, including each module and data file."""
    contents = []
    for wheel in built.wheels:
        with zipfile.ZipFile(wheel) as archive:
            contents.append({name: archive.read(name) for name in archive.namelist()})
    assert contents[0] == contents[1]
    names = {name for name in contents[0] if ".dist-info/" not in name}
    expected = {f"{package.replace('.', '/')}/{file.name}" for package, file in files_of_packages()}
    share = f"risorius-{PROJECT['project']['version']}.data/data/share/doc/risorius"
    expected |= {f"{share}/{page}" for page in PAGES}
    assert names == expected


@pytest.mark.slow
def test_sdist_holds_what_its_tests_need(built):
    """The sdist has the tests and the documentation, which packagers of systems need."""
    with tarfile.open(built.sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    wanted = {
        "Makefile",
        "constraints.txt",
        ".ci/run",
        "CHANGELOG.md",
        "LICENSE",
        "docs/hello.toml",
    }
    wanted |= {
        str(file.relative_to(ROOT))
        for folder in (".github", "docs", "examples", "tests")
        for file in tracked(folder)
    }
    assert wanted <= names
    assert not [name for name in names if name.endswith(".pyc")]
    assert not [name for name in names if Path(name).name in LEFTOVER_NAMES or ".#" in name]


@pytest.mark.slow
def test_installed_wheel_works_beside_files_of_the_same_names(built, tmp_path):
    """A user's own sim.py, refine.py and app/ have no effect; only `risorius` is installed."""
    for name in TOP_NAMES - {"app"}:
        (tmp_path / f"{name}.py").write_text("raise ImportError('of the user')\n")
    (tmp_path / "app").mkdir()
    (tmp_path / "app" / "__init__.py").write_text("raise ImportError('of the user')\n")
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    environment["NUMBA_CACHE_DIR"] = str(tmp_path / "compiled")
    surroundings = {"cwd": tmp_path, "env": environment}
    command = built.python.with_name("risorius")
    version = f"risorius, version {PROJECT['project']['version']}\n"
    assert run(command, "--version", **surroundings) == version
    assert run(built.python, "-m", "risorius", "--version", **surroundings) == version
    for words in (["--help"], ["demo", "--help"], ["doctor", "--offscreen", "--quiet"]):
        run(command, *words, **surroundings)
    arguments = ["capture", "--set", "joy", "--size", "64x64", "--quiet", "-o"]
    run(command, *arguments, tmp_path / "joy.png", **surroundings)
    assert (tmp_path / "joy.png").stat().st_size > 1000
    code = "from risorius import assets, refine, render, sim; print(sim.__file__)"
    site = Path(run(built.python, "-c", code, **surroundings)).parents[2]
    code = "from risorius.app.viewer.documents import manual; print(len(manual.pages()))"
    assert int(run(built.python, "-c", code, **surroundings)) == len(PAGES - {"gallery.md"})
    version = PROJECT["project"]["version"]
    assert {path.name for path in site.iterdir()} == {
        "needed.pth", "risorius", f"risorius-{version}.dist-info"
    }  # fmt: skip
