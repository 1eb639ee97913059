"""Bake the fine shape of a head's skin into a map of slopes: `risorius bench fine-shape`.

What is drawn of the head at rest, its mesh as the usual look refines it, is smoother than the form,
which `head.finer(2)` has: the map has the slopes of a height whose gradient turns the normals that
are drawn into those of the form (after Cohen, Olano, Manocha 1998, "Appearance-preserving
simplification"). Added is the relief of pores and of creases in the lips: dark in the picture of
the skin is deep (after Langer and Zucker 1994, "Shape-from-shading on a cloudy day").
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image
import scipy

from risorius.app.files import written_atomically
from risorius.app.refining.presets import Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.scenes import FaceScene
from risorius.assets import Segment
from risorius.assets.loading import load_head
from risorius.assets.model import FloatArray, Head
from risorius.geometry.colour import to_linear
from risorius.geometry.texels import Texels, rates

SIZE = 1024  # [texels] each way
MARGIN = 3.0  # [texels] beside a triangle that have its values, for what is blended across edges
SOFT = 2.0  # [texels] of the blur in which edges of triangles are lost
ALIKE, STEEPEST = 0.2, 0.6  # least cosine of normals that belong together; most gradient
FULL = 99.95  # [percent] of slopes that bytes hold as they are
RELIEF = 1.0  # [mm] of skin that is twice as light as what is around it; chosen by eye
PORES = 0.6, 2.4, 5.0  # [texels] of blurs: of the finest, of what is no pore, of what is around
SMOOTH = Segment.LEFT_BROW, Segment.RIGHT_BROW, Segment.LEFT_EYE, Segment.RIGHT_EYE, Segment.HAIR
HEM = 71  # [texels] around hair, within half of which its tips are painted
BESIDE = 17  # [texels] around what is smooth, within half of which nothing is rough
STRETCHED = Segment.NECK, Segment.HAIR  # where the layout is stretched, by up to thirty times


def make(head_file: Path) -> Path:
    """Bake the map of a head into the file beside its data file; returns that file."""
    head = load_head(head_file)
    slopes = (of_form(head) + of_skin(head)) * even(head)
    steepest = float(np.percentile(np.abs(slopes), FULL))
    levels = np.rint(128.0 + 127.0 * np.clip(slopes / steepest, -1.0, 1.0)).astype(np.uint8)
    made_from = np.array(head.fingerprint, dtype=np.uint32)
    steps = np.diff(levels, axis=0, prepend=np.zeros_like(levels[:1]))
    arrays: dict[str, Any] = {"steps": steps, "steepest": steepest, "made_from": made_from}
    with written_atomically(head.fine_shape_file) as part:
        np.savez_compressed(part, allow_pickle=False, **arrays)
    return head.fine_shape_file


def of_form(head: Head) -> FloatArray:
    """Slopes along u and v of the form over what is drawn [mm for a whole one], (SIZE, SIZE, 2)."""
    scene, fine = FaceScene(head), head.finer(2)
    drawn = refiner_for(scene, Refinement()).refine(scene.positions)
    assert drawn.uv is not None
    uv = fine.interpolate(head.uv)
    base = _image(drawn.uv[drawn.triangles], drawn.normals[drawn.triangles])
    true = _image(uv[fine.faces], fine.normals[fine.faces])
    along = rates(uv[fine.faces], fine.vertices[fine.faces])
    ways = _image(uv[fine.faces], np.repeat(along[:, None], 3, axis=1))
    for normals in (base, true):
        normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    facing = (base * true).sum(axis=2, keepdims=True)
    gradient = np.where(facing > ALIKE, base - true / np.maximum(facing, ALIKE), 0.0)
    length = np.linalg.norm(gradient, axis=2, keepdims=True)
    gradient *= np.minimum(1.0, STEEPEST / np.maximum(length, STEEPEST))
    return _blurred(np.einsum("hwjk,hwk->hwj", ways, gradient), SOFT)


def even(head: Head) -> FloatArray:
    """1 where the layout is even; 0 where it is stretched and slopes show its triangles."""
    is_stretched = scipy.ndimage.maximum_filter(np.isin(_classes(head), STRETCHED), BESIDE)
    return _blurred(1.0 - is_stretched[..., None], BESIDE / 2.0)


def of_skin(head: Head) -> FloatArray:
    """Slopes of its pores and creases, as they are painted, likewise."""
    classes = _classes(head)
    is_smooth = scipy.ndimage.maximum_filter(np.isin(classes, SMOOTH), BESIDE)
    is_smooth |= scipy.ndimage.maximum_filter(classes == Segment.HAIR, HEM)
    shown = PIL.Image.fromarray(head.albedo).resize((SIZE, SIZE), PIL.Image.Resampling.LANCZOS)
    light = to_linear(np.asarray(shown) / 255.0).mean(axis=2, keepdims=True)
    finest, wider, around = (_blurred(light, each) for each in PORES)
    rough = _blurred(1.0 - is_smooth[..., None], BESIDE / 4.0)
    height = RELIEF * rough * (finest - wider) / np.maximum(around, 0.02)
    down, right = np.gradient(SIZE * height[..., 0])
    return np.stack([right, -down], axis=2)


def _classes(head: Head) -> npt.NDArray[np.uint8]:
    shown = PIL.Image.fromarray(head.segments)
    return np.asarray(shown.resize((SIZE, SIZE), PIL.Image.Resampling.NEAREST))


def _blurred(image: FloatArray, sigma: float) -> FloatArray:
    return np.asarray(scipy.ndimage.gaussian_filter(image, (sigma, sigma, 0.0)))


def _image(places: npt.NDArray[Any], values: npt.NDArray[Any]) -> FloatArray:
    """What triangles at texture coordinates (F, 3, 2) have at their corners, (SIZE, SIZE, ...)."""
    texels = Texels.within(places.astype(np.float64), (SIZE, SIZE), MARGIN)
    image = np.zeros((SIZE, SIZE, *values.shape[2:]))
    image[texels.rows, texels.columns] = texels.interpolate(values)
    return image
