"""An installation without extras: pictures are drawn; a missing library gives one line."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

from risorius.app.cli.doctor import MODULES_OF_EXTRAS

from .command_line import report_lines

ROOT = Path(__file__).parents[2]
MISSING_PROGRAM = f"""
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {sum(MODULES_OF_EXTRAS.values(), ())!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Missing())
"""
RUN_PROGRAM = "from risorius.__main__ import run; run()"
IMPORTS_PROGRAM = """
import json
from click.testing import CliRunner
from risorius.__main__ import command

ended = [CliRunner().invoke(command(), words.split()) for words in sys.argv[1:]]
print(json.dumps([(each.exit_code, each.stderr) for each in ended]))
"""
EVERY_HELP = """
from click.testing import CliRunner
from risorius.__main__ import command

def ask(words, group):
    ended = CliRunner().invoke(main, [*words, "--help"])
    print(*words, ended.exit_code, "" if ended.exception is None else repr(ended.exception))
    for name, each in getattr(group, "commands", {}).items():
        ask([*words, name], each)

main = command()
ask([], main)
"""


def plain(*words, folder, code=RUN_PROGRAM):
    """The command as installed by `pip install risorius`."""
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    return subprocess.run(
        [sys.executable, "-c", MISSING_PROGRAM + code, *words],
        cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip


def each_of(*commands, folder):
    """Exit codes and error lines of commands, run in order in one process."""
    (folder / "take.csv").write_text("time,jawOpen\n0,0\n0.1,0.5\n0.2,0\n")
    (folder / "list.txt").write_text("export --set joy -o joy.npz\n")
    ended = plain(*commands, folder=folder, code=IMPORTS_PROGRAM)
    assert ended.returncode == 0, ended.stderr
    return [
        (code, [line for line in message.splitlines() if not line.startswith("Compiling")])
        for code, message in json.loads(ended.stdout)
    ]


def test_a_picture_needs_no_extra(tmp_path):
    """Pictures and glTF files need no extra."""
    picture = "capture --head coarse --set joy -o joy.png --size 64x48 --quiet"
    motion = "export --head coarse --set joy -o joy.glb --quiet"
    ended = each_of(picture, motion, folder=tmp_path)
    assert [code for code, _ in ended] == [0, 0], ended
    assert (tmp_path / "joy.png").exists()
    assert (tmp_path / "joy.glb").exists()


def test_help_needs_no_extra(tmp_path):
    """The help of the command, and of each command below it, needs no extra."""
    ended = plain(folder=tmp_path, code=EVERY_HELP)
    assert ended.returncode == 0, ended.stderr
    lines = [line.rstrip() for line in ended.stdout.splitlines()]
    assert len(lines) > 20
    assert [line for line in lines if not line.endswith(" 0")] == ["0"]


def test_the_doctor_lists_missing_extras(tmp_path):
    """The doctor reports what each missing extra installs.

    Without extras it reports pictures, but neither films nor a window.
    """
    ended = plain("doctor", folder=tmp_path)
    assert ended.returncode == 1, ended.stderr
    lines = report_lines(ended.stdout)
    every = ",".join(MODULES_OF_EXTRAS)
    remedy = f"for the others, in the checkout: pip install '.[{every}]'"
    assert lines["extras"] == f"none; {remedy}"
    assert lines["window"].startswith("no. the window needs imgui-bundle; install it")
    assert lines["Missing"].startswith("window, films;")


def test_a_missing_extra_is_named(tmp_path):
    """One line names the missing extra and the command that installs it; no file remains."""
    missing = {
        "view": "window",
        "replay take.csv --quiet": "window",
        "bench window": "window",
        "bench capture": "films",
        "capture --set joy -o joy.mp4 --size 64x48 --quiet": "films",
        "view --live vmc": "live",
        "export --set joy -o joy.usdz --quiet": "export",
        "export --set joy -o joy.vtkhdf --quiet": "export",
        "capture --set joy -o joy.png --passes depth --size 64x48 --quiet": "passes",
        "batch list.txt --scheduler tcp://127.0.0.1:9 --quiet": "cluster",
    }
    ended = each_of(*missing, folder=tmp_path)
    for (command, extra), (code, lines) in zip(missing.items(), ended, strict=True):
        assert code == 2 and len(lines) == 1, (command, code, lines)
        assert lines[0].endswith(f"; install it in the checkout: pip install '.[{extra}]'"), command
    assert {path.name for path in tmp_path.iterdir()} - {"list_logs"} == {"take.csv", "list.txt"}


def test_extras_install_their_libraries():
    """Each extra installs its libraries; `all` has every extra of a program's user."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    packages = {"pxr": "usd-core", "imgui_bundle": "imgui-bundle", "pythonosc": "python-osc"}
    for extra, modules in MODULES_OF_EXTRAS.items():
        for module in modules:
            package = packages.get(module, module.replace("_", "-"))
            assert any(each.startswith(package) for each in extras[extra]), module
            assert not any(each.startswith(package) for each in project["dependencies"]), module
    (everything,) = extras["all"]
    assert all(extra in everything for extra in MODULES_OF_EXTRAS)
