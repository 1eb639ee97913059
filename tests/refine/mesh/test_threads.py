"""Loops shared among threads: equal bits, every item once, and no thread for small meshes."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from risorius import refine
from risorius.refine.mesh import threads
from tests import meshes
from tests.refine.cases import sound_frame

ROOT = Path(__file__).resolve().parents[3]
LOOK_OPTIONS = {"scheme": "cubic", "criterion": "displacement+rest"}
OPTIONS_OF_REFINERS = {
    "look": LOOK_OPTIONS,
    "paper": {},
    "coherent": {"coherent": True},
    "loop, refined": {"blend": True, "normals": "refined"},
    "unblended": {"scheme": "cubic", "blend": False},
    "none": {},
}


def force_threads(monkeypatch, count):
    """Let threads share loops over small meshes, in many small parts."""
    monkeypatch.setattr(threads, "ITEMS_OF_PART", 16)
    monkeypatch.setattr(threads, "THREAD_COUNT", count)


@pytest.mark.parametrize("name", OPTIONS_OF_REFINERS)
@pytest.mark.parametrize("mesh", [meshes.irregular(4), meshes.tube(24, 12), meshes.with_debris()])
def test_bits_do_not_depend_on_threads(mesh, name, monkeypatch):
    """Frames made by one, two and three threads have the same bits, also with seams and debris."""
    refiner = "none" if name == "none" else "kahler"
    bound = [
        refine.create(
            refiner, mesh.faces, mesh.vertices, mesh.uv, mesh.face_uv, **OPTIONS_OF_REFINERS[name]
        )
        for _ in range(3)
    ]
    for seed in range(4):
        frame = meshes.wrinkled(mesh, seed)
        found = []
        for count, each in enumerate(bound, 1):
            force_threads(monkeypatch, count)
            made = sound_frame(each, frame)
            found.append(
                [array.tobytes() for array in (*made[:5], *each.origins()) if array is not None]
            )
        assert found[0] == found[1] == found[2]
        assert refiner == "none" or made.triangle_count > 1.2 * len(mesh.faces)


def test_every_item_once(monkeypatch):
    """The parts cover all items once, in any thread; an error in a part is raised in the caller."""
    force_threads(monkeypatch, 3)
    for count in (0, 1, 31, 32, 1000):
        done = np.zeros(count, np.int64)

        def add(first, last, items):
            items[first:last] += 1

        threads.parallel_for(add, count, done)
        assert (done == 1).all()

    def fail(first, last):
        if last == 1000:
            raise ValueError("the last part")

    with pytest.raises(ValueError, match="the last part"):
        threads.parallel_for(fail, 1000)


def test_small_meshes_start_no_thread(head, monkeypatch):
    """A face mesh is refined in the calling thread; with one numba thread, so is every mesh."""

    def refuse():
        raise AssertionError("a thread was started")

    monkeypatch.setattr(threads, "_threads", refuse)
    refiner = refine.create("kahler", head.faces, head.vertices, **LOOK_OPTIONS)
    assert refiner.refine(1.01 * head.vertices).triangle_count > len(head.faces)
    monkeypatch.setattr(threads, "THREAD_COUNT", 1)
    threads.parallel_for(lambda first, last: None, 1_000_000)
    monkeypatch.setattr(threads, "THREAD_COUNT", 2)
    with pytest.raises(AssertionError, match="a thread was started"):
        threads.parallel_for(lambda first, last: None, 1_000_000)


FORKED_PROGRAM = """
import os
from risorius import refine
from risorius.refine.mesh import threads
from tests import meshes
threads.ITEMS_OF_PART, threads.THREAD_COUNT = 16, 2
mesh = meshes.irregular(4)
frame = meshes.wrinkled(mesh, 1)
refiner = refine.create("kahler", mesh.faces, mesh.vertices, **{LOOK})
before = refiner.refine(frame).positions.copy()
child = os.fork()
same = (refiner.refine(frame).positions == before).all()
if child == 0:
    os._exit(0 if same else 3)
assert same and os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_forked_processes_have_their_own_threads():
    """A forked child refines like its parent, although it does not have the parent's threads."""
    code = FORKED_PROGRAM.replace("{LOOK}", repr(LOOK_OPTIONS))
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", code],
        cwd=ROOT, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
