"""Scripts: a table of odd ones, and hundreds with random damage."""

import random
from pathlib import Path

import pytest

from risorius.app.capture.drawing import camera_for
from risorius.app.errors import UserError
from risorius.app.performances import script_for
from risorius.app.scenes import SCENES, FaceScene, Scene
from risorius.app.script.script_file import parse_script, script_text

from .damage import SEED, changed
from .sandbox import bounded, check_line

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
SHIPPED_SCRIPTS = [
    path.read_bytes() for path in sorted((ROOT / "assets" / "scripts").glob("*.toml"))
]
SHIPPED_SCRIPTS.append(
    b"[tracks]\njoy = '''\n" + b"".join(b"%d 0.5 hold\n" % n for n in range(99)) + b"'''\n"
)
ROUNDS = 400
ONE_KEY = "[[pose]]\ntime = 1\njoy = 1\n"
ACCEPTED_SCRIPTS = {
    "a mark of byte order": b"\xef\xbb\xbf" + ONE_KEY.encode(),
    "line ends of Windows": ONE_KEY.replace("\n", "\r\n").encode(),
    "tiny value": b"[[pose]]\ntime = 1\njoy = 1e-320\n",
    "a day": b"duration = 86400\n[[pose]]\ntime = 86400.0\njoy = 1\n",
    "a name in all scripts": "[[pose]]\ntime = 1\nname = 'радость 喜び 😀'\n".encode(),
    "a track of lines": b"[tracks]\njoy = '''\n0 0\n 1\t0.5 hold \r\n\n2 -1e-320\n'''\n",
    "a million lines": b"[tracks]\njoy = '''\n"
    + b"\n".join(b"%d.%02d 0" % divmod(n, 100) for n in range(1_000_000))
    + b"'''\n",
    "ten thousand keys": b"".join(b"[[pose]]\ntime = %d\njoy = 1\n" % n for n in range(10_000)),
}
TOKENS = (
    b"nan", b"inf", b"-1", b"1e400", b"9" * 400, b"true", b"''", b'"\\n"', b"[]", b"{}", b"[",
    b"\xef\xbb\xbf",
    b"[[pose]]", b"[tracks]", b"time = 0", b"=", b"\n", b"#", b"\x00", b"\xff", b"\r",
)  # fmt: skip


@pytest.fixture(scope="module")
def scenes(face: FaceScene) -> dict[str, Scene]:
    """One scene of each kind."""
    return {"face": face, "plane": SCENES["plane"]()}


def opened(path, scenes):
    """Read a script, and check all its requests, without drawing."""
    with bounded():
        script = script_for(path, None)
        script.check(scenes[script.scene].limits)
        camera_for(scenes[script.scene], script.camera)
    return script


@pytest.mark.parametrize("name", ACCEPTED_SCRIPTS)
def test_odd_scripts(name, tmp_path, scenes):
    """Odd but valid scripts are read."""
    path = tmp_path / "odd.toml"
    path.write_bytes(ACCEPTED_SCRIPTS[name])
    assert opened(path, scenes).duration > 0.0


def damaged(chance):
    """A good script with a few places changed."""
    content = bytearray(chance.choice(SHIPPED_SCRIPTS))
    start = chance.randrange(len(content))
    content = content[start if chance.random() < 0.2 else 0 :][: chance.choice((200, 2000, 20000))]
    return changed(content, chance, TOKENS)


@pytest.mark.parametrize("number", range(ROUNDS))
def test_damaged_scripts(number, tmp_path, scenes):
    """A damaged script is refused in one line, or read.

    A read script has values, and is written unchanged.
    """
    seed = SEED + number
    path = tmp_path / "damaged.toml"
    path.write_bytes(damaged(random.Random(seed)))
    try:
        script = opened(path, scenes)
    except UserError as error:
        check_line(str(error))
        return
    for time in (0.0, 0.3, script.duration, 1e5):
        assert all(abs(value) < 1e4 for value in script.at(time).values()), seed
    assert parse_script(script_text(script), source=str(path)) == script, seed
