"""The refiner on the graphics card beside that of the processor, with which it must agree."""

from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.refine_gl import KahlerGl

Points = npt.NDArray[np.float64]
LOOK: dict[str, Any] = {"scheme": "cubic", "criterion": "displacement+rest"}
RULES: dict[str, dict[str, Any]] = {
    "one level": {"threshold_twice": np.inf},
    "two levels": {},
    "window's look": LOOK,
}


def bound_twice(
    faces: npt.ArrayLike, rest: npt.ArrayLike, **options: Any
) -> tuple[refine.Refiner, KahlerGl]:
    """The refiners `kahler` and `kahler-gl` of one mesh, with the same options."""
    on_card = refine.create("kahler-gl", faces, rest, **options)
    assert isinstance(on_card, KahlerGl), "no OpenGL 4.3: apt install libegl1 libgl1-mesa-dri"
    return refine.create("kahler", faces, rest, **options), on_card


def assert_same(
    processor: refine.Refiner,
    card: KahlerGl,
    positions: Points,
    view: refine.View | None = None,
) -> refine.RefinedMesh:
    """Refine a frame by both; splits, triangles, rows and attributes are the same to the bit."""
    wanted = processor.refine(positions, view=view)
    got = card.refine(positions, view=view)
    np.testing.assert_array_equal(card.splits, processor.splits)
    assert (got.vertex_count, got.triangle_count) == (wanted.vertex_count, wanted.triangle_count)
    np.testing.assert_array_equal(got.triangles, wanted.triangles)
    np.testing.assert_array_equal(got.source, wanted.source)
    np.testing.assert_array_equal(bits(got.positions), bits(wanted.positions))
    np.testing.assert_array_equal(bits(got.normals), bits(wanted.normals))
    assert (got.uv is None) == (wanted.uv is None)
    values = {"uv": (got.uv, wanted.uv)} if got.uv is not None else {}
    values |= {name: (got.attributes[name], wanted.attributes[name]) for name in wanted.attributes}
    for ours, theirs in values.values():
        np.testing.assert_array_equal(bits(ours), bits(theirs))
    for ours, theirs in zip(card.origins(), processor.origins(), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    return got


def bits(numbers: Any) -> npt.NDArray[np.uint32]:
    """Numbers in single precision as their bits; there is one zero."""
    return np.ascontiguousarray(numbers + np.float32(0.0)).view(np.uint32)
