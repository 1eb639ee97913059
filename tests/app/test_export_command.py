"""`risorius export`: complete files or none, and one line for impossible requests."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from risorius.app.export.formats import MOTION_FORMATS

from .command_line import refusal, risorius

pytestmark = pytest.mark.usefixtures("shared_scenes")

PLANE_SCRIPT = 'scene = "plane"\nduration = 0.2\n[[pose]]\ntime = 0.0\namplitude = 1.0\n'
FACE_SCRIPT = "duration = 0.1\n[[pose]]\ntime = 0.0\njoy = 1.0\n"
OUTPUTS = {
    each.name: f"out{each.suffixes[0]}" if each.suffixes else "out"
    for each in MOTION_FORMATS
    if each.name != "arkit"
}
FULL_DISK = """
import resource, sys
from pathlib import Path
from risorius.app.errors import report_user_errors
from risorius.app.export.clip import record
from risorius.app.export.formats import ExportRequest, format_for, write
from risorius.app.script.script_file import load_script

output = Path(sys.argv[1])
clip = record(load_script(Path("plane.toml")), None, 240.0, progress=False)
chosen = format_for(output, sys.argv[2])
chosen.load()
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))  # [bytes] of any file
with report_user_errors():
    write(clip, output, chosen, ExportRequest(progress=False))
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a script, as the working directory."""
    monkeypatch.chdir(tmp_path)
    Path("plane.toml").write_text(PLANE_SCRIPT)
    Path("face.toml").write_text(FACE_SCRIPT)
    return tmp_path


def export(*arguments):
    """Run the command in this process."""
    return risorius("export", *arguments, "--quiet")


@pytest.mark.parametrize("name", OUTPUTS)
def test_every_format_is_written_and_leaves_nothing_else(name, folder):
    """Every format in the table is written, also a second time, without other files."""
    for _ in range(2):
        arguments = ("plane.toml", "--as", name, "-o", OUTPUTS[name], "--overwrite")
        result = export(*arguments)
        assert result.exit_code == 0, result.output
        assert re.search(r"7 frames, 154 triangles, [1-9]\d* kB$", result.output, re.MULTILINE)
    chosen = next(each for each in MOTION_FORMATS if each.name == name)
    allowed = {path.name for path in chosen.outputs(Path(OUTPUTS[name]))}
    found = {item.name for item in folder.iterdir()} - {"plane.toml", "face.toml"}
    assert OUTPUTS[name] in found
    assert found <= allowed
    if not chosen.suffixes:
        assert len(list((folder / "out").glob(f"frame_*.{name}"))) == 7


def test_curves_need_muscles():
    """Curves of a face are written; for a plane, which has no muscles, one line refuses them."""
    assert "use the scene face" in refusal(export("plane.toml", "-o", "x.csv"))
    assert not Path("x.csv").exists()
    result = export("face.toml", "-o", "x.csv")
    assert result.exit_code == 0
    assert Path("x.csv").stat().st_size > 1000


def test_only_a_dense_head_has_a_simplified_mesh():
    """The built-in head has no simplified mesh: one line reports this before any writing."""
    line = refusal(export("face.toml", "-o", "x.npz", "--simplified"))
    assert line.startswith("risorius: --simplified: this mesh is simulated as it is; leave it out")
    assert not Path("x.npz").exists()


def test_other_files_stay(folder):
    """Files beside the output, a user's head, and files in a folder stay."""
    Path("x.obj").write_text("mine")
    line = refusal(export("plane.toml", "-o", "x.pc2"))
    assert "x.obj: exists already, and x.pc2 needs a file of this name" in line
    Path("frames").mkdir()
    Path("frames/notes.txt").write_text("mine")
    line = refusal(export("plane.toml", "--as", "obj", "-o", "frames"))
    assert (
        line
        == "risorius: frames: exists and is not empty; choose another folder, or add --overwrite"
    )
    Path("frames/frame_00099.obj").write_text("of an earlier time")
    result = export("plane.toml", "--as", "obj", "-o", "frames", "--overwrite")
    assert result.exit_code == 0, result.output
    assert Path("frames/notes.txt").read_text() == Path("x.obj").read_text() == "mine"
    assert not Path("frames/frame_00099.obj").exists()
    Path("head.json").write_text("{}")
    head = ("--head", "head.obj", "--landmarks", "head.json")
    line = refusal(export("face.toml", "-o", "head.pc2", *head))
    assert "head.obj: is both an input and an output" in line


@pytest.mark.slow
@pytest.mark.parametrize("name", OUTPUTS)
def test_a_full_disk_is_one_line(name, folder):
    """If the system limits the size of files, one line reports it, and the old file stays."""
    output = Path(OUTPUTS[name])
    if output.suffix:
        output.write_text("mine")
    words = [sys.executable, "-c", FULL_DISK, str(output), name]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    assert result.returncode == 2, result.stderr
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"risorius: {output}: cannot be written: ")
    assert ".risorius-" not in line
    left = {item.name for item in folder.iterdir()} - {"plane.toml", "face.toml"}
    assert left == ({output.name} if output.suffix else set())
    assert not output.suffix or output.read_text() == "mine"
