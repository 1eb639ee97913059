"""Machine code that is bound, kept and found again."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import refine
from refine import machine_code, on_compile
from refine.kernels import kernel
from refine.native import Turns, native

HALF = np.float32(0.5)
START = """
import json, sys
import numpy
import NAME as refine
told = []
refine.on_compile(lambda: told.append(1))
faces = numpy.array([[0, 1, 2], [2, 1, 3]])
rest = numpy.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
options = json.loads(sys.argv[1])
refiner = refine.create("kahler", faces, rest, **options)
mesh = refiner.refine(rest + rest[:, :1] * rest[:, 1:2])
print(len(told), "numba" in sys.modules, len(mesh.triangles))
"""


@kernel
def halved(x: np.float32) -> np.float32:
    """A kernel that a native one calls."""
    return np.float32(x * HALF)


@native
def scale_rows(rows: Any, flags: Any, scaled: Any, add: int) -> int:
    """Halve the second column of the rows with a flag; return their number and `add`."""
    count = 0
    for k in range(rows.shape[0]):
        if flags[k]:
            scaled[k, 1] = halved(rows[k, 1])
            count += 1
    return count + add


@native
def allocating(numbers: Any) -> float:
    """What is not allowed."""
    return float(np.zeros(len(numbers)).sum())


@pytest.fixture
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own, and nothing loaded before."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    for cached in (machine_code.load, machine_code._folder):
        cached.cache_clear()
    yield tmp_path
    for cached in (machine_code.load, machine_code._folder):
        cached.cache_clear()


def some_rows(columns: int) -> tuple[Any, Any, Any]:
    """Arguments of the kernel above."""
    rows = np.arange(3.0 * columns, dtype=np.float32).reshape(3, columns)
    return rows, np.array([True, False, True]), np.zeros_like(rows)


@pytest.mark.parametrize("columns", [2, 3, 8])
def test_bound_arguments(columns: int) -> None:
    """A call reads and writes its arrays where they are, whatever is in them by then."""
    rows, flags, scaled = some_rows(columns)
    call = scale_rows.bind(rows, flags, scaled, 10)
    assert call() == 12
    assert scaled[:, 1].tolist() == [rows[0, 1] / 2, 0, rows[2, 1] / 2]
    flags[:] = False
    assert call() == 10
    longer = np.ones((5, columns), dtype=np.float32), np.ones(5, dtype=bool), np.zeros((5, columns))
    call.put("rows", longer[0])
    call.put("flags", longer[1])
    call.put("scaled", longer[2].astype(np.float32))
    call.put("add", -1)
    assert call() == 4


def test_again() -> None:
    """The same objects give the same call, an equal one does not."""
    arguments = (*some_rows(3), 1)
    call = scale_rows.bind(*arguments)
    assert scale_rows.again(call, *arguments) is call
    assert scale_rows.again(call, arguments[0].copy(), *arguments[1:]) is not call
    assert scale_rows.again(None, *arguments)() == 3


def test_turns() -> None:
    """Calls in turn run one after the other, up to one that returns something else than 0."""
    rows, flags, scaled = some_rows(3)
    first = scale_rows.bind(rows, flags, scaled, -2)
    second = scale_rows.bind(scaled, flags, rows, 5)
    turns = Turns(first, second)
    assert turns() == 7
    assert rows[0, 1] == scaled[0, 1] / 2 == 0.25
    first.put("add", 1)
    rows[2, 1] = 8.0
    assert turns() == 3
    assert scaled[2, 1] == 4.0
    assert rows[2, 1] == 8.0
    first.put("add", -2)
    second.put("add", -2)
    assert turns() == 0
    assert Turns()() == 0


def test_only_whole_arrays() -> None:
    """An array with gaps would be read wrongly, so it is refused."""
    rows, flags, scaled = some_rows(4)
    with pytest.raises(AssertionError, match="in one piece"):
        scale_rows.bind(rows[:, :2], flags, scaled, 0)


def test_nothing_that_needs_numba(empty_folder: Path) -> None:
    """A kernel that allocates would crash without numba, so it is refused when it is compiled."""
    with pytest.raises(AssertionError, match=r"allocating.* allocates or raises"):
        allocating.bind(np.zeros(3))


@pytest.mark.parametrize("damage", ["none", "torn", "source"])
def test_kept_code(empty_folder: Path, damage: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Code on disk is used again, unless it is torn or a file that it is made from has changed."""
    told: list[int] = []
    arguments = (*some_rows(3), 0)
    assert scale_rows.bind(*arguments)() == 2
    (file,) = empty_folder.glob("*.o")
    content = file.read_bytes()
    if damage == "torn":
        file.write_bytes(content[:-1])
    if damage == "source":
        monkeypatch.setattr(machine_code, "_digest", lambda file: f"another {file}")
    machine_code.load.cache_clear()
    on_compile(lambda: told.append(1))
    assert scale_rows.bind(*arguments)() == 2
    assert len(told) == (damage != "none")
    assert (file.read_bytes()[:32] == content[:32]) == (damage != "source")


def test_sources_of_other_kernels() -> None:
    """Code depends on the files of the kernels that a kernel calls, and on its own."""
    from refine import masks, normals, output

    own, called, other = (machine_code._digest(m.__file__) for m in (masks, normals, output))
    assert own in machine_code._sources(masks.place_points)
    assert called in machine_code._sources(masks.place_points)
    assert other not in machine_code._sources(masks.place_points)
    assert machine_code._digest(__file__) in machine_code._sources(scale_rows)


def test_lifted_out_it_compiles_once(tmp_path: Path) -> None:
    """Copied alone elsewhere under another name the folder refines; later starts need no numba."""
    (tmp_path / "lifted").mkdir()
    for path in Path(refine.__file__).parent.glob("*.py"):
        (tmp_path / "lifted" / path.name).write_bytes(path.read_bytes())
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "compiled")}
    starts = [_start("lifted", {}, tmp_path, environment) for _ in range(2)]
    assert starts[0][:2] == ["1", "True"]
    assert starts[1][:2] == ["0", "False"]
    assert starts[0][2] == starts[1][2]
    assert int(starts[0][2]) > 2


@pytest.mark.parametrize(
    "options",
    [{"blend": True}, {"coherent": True}, {"scheme": "cubic"}, {"scheme": "cubic", "blend": False}],
    ids=["blend", "coherent", "cubic", "cubic, no blend"],
)
def test_later_starts_need_no_numba(options: dict[str, Any]) -> None:
    """Blending, coherence and cubic edges are native through and through, binding included."""
    root = Path(refine.__file__).parents[1]
    _, later = (_start("refine", options, root, dict(os.environ)) for _ in range(2))
    assert later[:2] == ["0", "False"]
    assert int(later[2]) > 2


def _start(
    name: str, options: dict[str, Any], folder: Path, environment: dict[str, str]
) -> list[str]:
    """What a fresh interpreter says of its first frame."""
    program = START.replace("NAME", name)
    return subprocess.run(
        [sys.executable, "-c", program, json.dumps(options)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
