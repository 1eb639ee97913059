"""The graphics card's refiner: binding, lent arrays, errors, and the fallback to the processor."""

import ast
import logging
import re
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from risorius import refine, refine_gl, render
from risorius.refine import port
from risorius.refine_gl import GpuError, frames, refiner, tables
from risorius.refine_gl.refined import GpuBuffers
from tests import meshes

from .agreement import RULES, assert_same, bits, bound_twice

MESH = meshes.irregular(1, columns=6, rows=5, holes=1)
BENT_POSITIONS = meshes.wrinkled(MESH, 3, 0.5)


def bound(**options):
    """Both refiners for a small mesh, with the same options."""
    return bound_twice(MESH.faces, MESH.vertices, **options)


def test_it_is_found_by_an_entry_point():
    """`kahler-gl` is found by its entry point, has its own options, and refuses wrong options."""
    assert "kahler-gl" in refine.refiners.available()
    assert "kahler-gl" in refine.refiners.installed()
    names = [each.name for each in refine.parameters("kahler-gl")]
    assert {"threshold_once", "threshold_twice", "coherent"} <= set(names)
    with pytest.raises(ValueError, match="unknown option 'sharpness' for refiner 'kahler-gl'"):
        refine.create("kahler-gl", MESH.faces, MESH.vertices, sharpness=1)
    with pytest.raises(ValueError, match="coherent was maybe, must be on or off"):
        refine.create("kahler-gl", MESH.faces, MESH.vertices, coherent="maybe")
    with pytest.raises(ValueError, match="threshold_once and threshold_twice are drops"):
        refine.create("kahler-gl", MESH.faces, MESH.vertices, threshold_once=1.0)


def test_wrong_frames_are_refused():
    """Wrong frames are refused as by `kahler`, and the next good frame is correct."""
    processor, card = bound()
    for wrong, words in (
        (BENT_POSITIONS[1:], "must be floats of shape"),
        (BENT_POSITIONS * np.nan, "must be finite"),
    ):
        with pytest.raises(ValueError, match=words):
            card.refine(wrong)
        with pytest.raises(ValueError, match=words):
            card.refine(wrong, out=lent(card))
    assert_same(processor, card, BENT_POSITIONS)


def lent(card):
    """Arrays with room for any frame."""
    return SimpleNamespace(
        vertices=np.zeros((card.vertex_capacity, card.vertex_columns), np.float32),
        triangles=np.zeros((card.triangle_capacity, 3), np.uint32),
        source=np.zeros(card.triangle_capacity, np.int32),
    )


def test_lent_arrays_are_filled():
    """A frame is written into the lent arrays."""
    processor, card = bound()
    stream = lent(card)
    wanted = processor.refine(BENT_POSITIONS)
    mesh = card.refine(BENT_POSITIONS, out=stream)
    assert np.shares_memory(mesh.positions, stream.vertices)
    assert_array_equal(bits(mesh.positions), bits(wanted.positions))
    assert_array_equal(mesh.triangles, wanted.triangles)
    assert_array_equal(mesh.source, wanted.source)
    with pytest.raises(ValueError, match=re.escape("stream.triangles must be a writable")):
        card.refine(BENT_POSITIONS, out=SimpleNamespace(**{**vars(stream), "triangles": None}))


@pytest.fixture
def surface() -> Iterator[render.Surface]:
    """Another OpenGL context, current in this thread."""
    with render.open_offscreen((32, 32)) as opened:
        yield opened


def test_buffers_of_another_context(surface):
    """The context of the given buffers is used; data are transferred only when they are read."""
    processor, card = bound()
    room = card.vertex_columns, card.vertex_capacity, card.triangle_capacity
    stream = GpuBuffers(surface.gl, *room)
    mesh = card.refine_on_card(BENT_POSITIONS, stream)
    wanted = processor.refine(BENT_POSITIONS)
    assert not {"vertices", "triangles", "source", "_counts"} & set(vars(mesh))
    assert mesh.triangle_count == wanted.triangle_count
    assert "vertices" not in vars(mesh)
    assert_array_equal(bits(mesh.positions), bits(wanted.positions))
    refine.check(card, mesh, BENT_POSITIONS)
    command = np.frombuffer(stream.command_buffer.read(), np.uint32)
    assert command.tolist() == [
        *(3 * wanted.triangle_count, 1, 0, 0, 0),
        *(wanted.vertex_count, wanted.triangle_count),
    ]


@pytest.mark.parametrize("rules", ["two levels", "window's look"])
def test_a_new_context_gets_the_mesh_again(rules):
    """After the buffers are lost with a closed window, the next context gets the mesh again."""
    processor, card = bound(**RULES[rules])
    wanted = processor.refine(BENT_POSITIONS)
    room = card.vertex_columns, card.vertex_capacity, card.triangle_capacity
    for size in ((32, 32), (64, 48)):
        with render.open_offscreen(size) as surface:
            mesh = card.refine_on_card(BENT_POSITIONS, GpuBuffers(surface.gl, *room))
            assert_array_equal(bits(mesh.positions), bits(wanted.positions))
    assert_same(processor, card, BENT_POSITIONS)


def test_the_callers_context_stays_current(surface):
    """Frames without a given context do not change the current context."""
    _, card = bound()
    surface.begin()
    surface.gl.clear(1.0, 0.0, 0.0)
    surface.end()
    card.refine(BENT_POSITIONS).positions.copy()
    assert surface.read()[0, 0].tolist() == [255, 0, 0]


@pytest.fixture
def without_opengl(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make OpenGL too old for the refiner."""

    def fails():
        """Fail as `own_context` does with OpenGL 4.1."""
        raise GpuError("no OpenGL 4.3 without a window (it has 4.1)")

    refiner.warn_once.cache_clear()
    monkeypatch.setattr(refiner, "own_context", fails)


@pytest.mark.usefixtures("without_opengl")
def test_without_opengl_the_processor_refines(caplog):
    """One line reports the missing OpenGL once, and the result equals that of `kahler`."""
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            other = refine.create("kahler-gl", MESH.faces, MESH.vertices, threshold_once=0.01)
    assert caplog.messages == [
        "kahler-gl: no OpenGL 4.3 without a window (it has 4.1); the processor refines instead "
        "(kahler)"
    ]
    assert type(other) is refine.Kahler
    wanted = refine.create("kahler", MESH.faces, MESH.vertices, threshold_once=0.01).refine(
        BENT_POSITIONS
    )
    assert_array_equal(other.refine(BENT_POSITIONS).triangles, wanted.triangles)


def test_a_driver_that_refuses_a_shader(monkeypatch, caplog):
    """If a driver refuses a shader, the processor refines; the line has the driver's message."""
    whole = frames.shader_text
    refiner.warn_once.cache_clear()
    monkeypatch.setattr(frames, "shader_text", lambda name: whole(name) + "?" * (name == "mark"))
    with caplog.at_level(logging.WARNING):
        assert type(refine.create("kahler-gl", MESH.faces, MESH.vertices)) is refine.Kahler
    (line,) = caplog.messages
    assert line.startswith("kahler-gl: the driver refuses mark.glsl: ")
    assert "error" in line


def test_shaders_take_eight_buffers():
    """Shaders stay within OpenGL 4.3's limits.

    The limits are eight storage buffers, and a largest thread group.
    """
    bindings = re.findall(r"std430, binding = (\d+)", frames.shader_text("common"))
    assert sorted(map(int, bindings)) == list(range(8))
    assert tables.GROUP_SIZE <= 1024


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"scheme": "detail"}, "scheme was detail, must be loop or cubic"),
        ({"blend": True}, 'blend=True needs scheme="cubic" in kahler-gl'),
        ({"blend": True, "scheme": "cubic", "coherent": True}, "and coherent=False"),
        ({"criterion": "displacement"}, 'criterion "displacement" needs scheme="cubic"'),
    ],
)
def test_options_of_the_processor_are_refused(options, words):
    """Options that only `kahler` has are refused by name."""
    with pytest.raises(ValueError, match=re.escape(words)):
        refine.create("kahler-gl", MESH.faces, MESH.vertices, **options)


def test_it_imports_public_names_only():
    """The plug-in imports only `risorius.refine` and `refine.port`, by exported names."""
    folder = Path(refine_gl.__file__).parent
    for file in folder.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
            if not module.startswith("risorius.refine"):
                continue
            assert module == "risorius.refine", (file.name, module)
            assert {each.name for each in node.names} <= {*refine.__all__, "port"}, file.name
    used = set(re.findall(r"\bport\.(\w+)", "".join(f.read_text() for f in folder.glob("*.py"))))
    assert used <= set(port.__all__)
