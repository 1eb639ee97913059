"""The graphics card's refiner must agree with the processor's.

They agree to the bit if the driver rounds quotients and roots like a processor; OpenGL permits
errors of some bits. A test program decides for each driver: Mesa's software driver and NVIDIA's
round correctly.
"""

import functools
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_array_equal

from risorius import refine
from risorius.geometry.arrays import Floats64, Unsigned32
from risorius.refine_gl import KahlerGl
from risorius.refine_gl.context import GpuError, own_context

LOOK_OPTIONS: dict[str, Any] = {"scheme": "cubic", "criterion": "displacement+rest"}
RULES: dict[str, dict[str, Any]] = {
    "one level": {"threshold_twice": np.inf},
    "two levels": {},
    "window's look": LOOK_OPTIONS,
}

ROUNDING_SHADER = """#version 430 core
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Numbers { float numbers[]; };
void main() {
    uint k = 4u * gl_GlobalInvocationID.x;
    precise float quotient = numbers[k] / numbers[k + 1u];
    precise float root = 1.0 / sqrt(numbers[k]);
    numbers[k + 2u] = quotient;
    numbers[k + 3u] = root;
}
"""


def why_no_card() -> str:
    """The reason why the card cannot refine, or an empty text.

    A missing OpenGL is an error, not a reason to skip a test.
    """
    try:
        own_context()
    except GpuError as error:
        return str(error) if "version" in str(error) else ""
    return ""


@functools.cache
def why_not_exact() -> str:
    """The reason why the card cannot be compared with the processor's bits, or an empty text."""
    if reason := why_no_card():
        return reason
    own = own_context()
    if own.run(rounds_as_processors, own.gl):
        return ""
    name = str(own.run(own.gl.info.__getitem__, "GL_RENDERER"))
    return f"{name} rounds quotients or roots otherwise than a processor"


def rounds_as_processors(gl: moderngl.Context) -> bool:
    """Whether compute shaders divide and take roots correctly to the last bit."""
    numbers = np.random.default_rng(1).uniform(0.5, 2.0, (64 * 64, 4)).astype(np.float32)
    buffer = gl.buffer(numbers.tobytes())
    buffer.bind_to_storage_buffer(0)
    gl.compute_shader(ROUNDING_SHADER).run(len(numbers) // 64)
    gl.memory_barrier()
    found = np.frombuffer(buffer.read(), np.float32).reshape(-1, 4)
    roots = np.float32(1.0) / np.sqrt(numbers[:, 0])
    expected = np.stack([numbers[:, 0] / numbers[:, 1], roots], axis=1)
    return bool((found[:, 2:] == expected).all())


@pytest.fixture
def exact_driver() -> None:
    """Skip a test, with the reason, if the card cannot be compared with the processor's bits."""
    if reason := why_not_exact():
        pytest.skip(reason)


needs_exact_driver = pytest.mark.usefixtures("exact_driver")
"""Mark of tests that compare bits, or pictures pixel by pixel."""


def bound_twice(
    faces: npt.ArrayLike, rest: npt.ArrayLike, **options: Any
) -> tuple[refine.Refiner, KahlerGl]:
    """The refiners `kahler` and `kahler-gl` of one mesh, with the same options."""
    if reason := why_not_exact():
        pytest.skip(reason)
    on_card = refine.create("kahler-gl", faces, rest, **options)
    assert isinstance(on_card, KahlerGl), "no OpenGL 4.3: apt install libegl1 libgl1-mesa-dri"
    return refine.create("kahler", faces, rest, **options), on_card


def assert_same(
    processor: refine.Refiner,
    card: KahlerGl,
    positions: Floats64,
    view: refine.View | None = None,
) -> refine.RefinedMesh:
    """Refine a frame on both.

    Check that splits, triangles, rows and attributes are equal to the bit.
    """
    wanted = processor.refine(positions, view=view)
    got = card.refine(positions, view=view)
    assert_array_equal(card.splits, processor.splits)
    assert (got.vertex_count, got.triangle_count) == (wanted.vertex_count, wanted.triangle_count)
    assert_array_equal(got.triangles, wanted.triangles)
    assert_array_equal(got.source, wanted.source)
    assert_array_equal(bits(got.positions), bits(wanted.positions))
    assert_array_equal(bits(got.normals), bits(wanted.normals))
    assert (got.uv is None) == (wanted.uv is None)
    values = {"uv": (got.uv, wanted.uv)} if got.uv is not None else {}
    values |= {name: (got.attributes[name], wanted.attributes[name]) for name in wanted.attributes}
    for ours, theirs in values.values():
        assert_array_equal(bits(ours), bits(theirs))
    for ours, theirs in zip(card.origins(), processor.origins(), strict=True):
        assert_array_equal(ours, theirs)
    return got


def bits(numbers: Any) -> Unsigned32:
    """Numbers in single precision as integers of their bits; both zeros are equal."""
    return np.ascontiguousarray(numbers + np.float32(0.0)).view(np.uint32)
