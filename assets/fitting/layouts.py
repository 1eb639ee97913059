"""From one layout of a skin's texture to another: pictures and maps drawn anew, texel by texel.

A mesh that brings a picture has its own texture coordinates; the maps of the built-in head (of its
wrinkles, of what is nose or lip) lie in others. Everything drawn has one layout in the end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.texels import Texels

from ..data_files import Image
from ..errors import AssetError
from ..model import FloatArray, Head, IndexArray, Segment, SingleArray, Wrinkles
from ..pictures import LARGEST, Texture

SIZE = 1024  # [texels] each way of maps that are drawn anew
STEEPEST = 99.9  # [percent] of slopes that a map of wrinkles holds as they are


@dataclass(frozen=True)
class Layout:
    """Where the corners of triangles lie in a picture: texture coordinates and their numbers."""

    uv: SingleArray
    face_uv: IndexArray

    @property
    def corners(self) -> FloatArray:
        """Texture coordinates of each triangle's corners, shape (F, 3, 2)."""
        return self.uv.astype(np.float64)[self.face_uv]


def texels_within(layout: Layout, size: tuple[int, int]) -> Texels:
    """The texels of a picture of (height, width) that triangles lie over, and one beside them.

    Raises AssetError where triangles cover the picture many times over.
    """
    try:
        return Texels.within(layout.corners, size, margin=1.0)  # for what is blended across edges
    except ValueError:
        raise AssetError(
            "its texture coordinates cover the picture many times over; unwrap it anew, or remove "
            "its materials"
        ) from None


def sampled(picture: npt.NDArray[np.uint8], uv: FloatArray) -> npt.NDArray[np.uint8]:
    """The texels of a picture at texture coordinates (n, 2)."""
    height, width = picture.shape[:2]
    columns, rows = np.floor(uv * [width, -height] + [0.0, height]).astype(np.int64).T
    found: npt.NDArray[np.uint8] = picture[rows.clip(0, height - 1), columns.clip(0, width - 1)]
    return found


def _between_texels(steps: npt.NDArray[np.int8], uv: FloatArray) -> FloatArray:
    """Heights (H, W, k) at texture coordinates (n, 2): they are form, and must have no stairs."""
    height, width = steps.shape[:2]
    at = (uv * [width, -height] + [-0.5, height - 0.5]).T[::-1]
    layers = np.moveaxis(steps.astype(np.float64), -1, 0)
    found = [scipy.ndimage.map_coordinates(each, at, order=1, mode="nearest") for each in layers]
    return np.stack(found, axis=1).round()


def drawn_over(picture: Image, layout: Layout, colours: FloatArray | tuple[Image, Layout]) -> Image:
    """A picture with triangles of `layout` drawn over it.

    colours: of each corner, shape (F, 3, 3), or another picture and where they lie in it.
    """
    texels = texels_within(layout, picture.shape[:2])
    if isinstance(colours, tuple):
        found = sampled(colours[0], texels.interpolate(colours[1].corners))
    else:
        found = texels.interpolate(colours).round().clip(0, 255).astype(np.uint8)
    drawn = picture.copy()
    drawn[texels.rows, texels.columns] = found
    return drawn


def maps_in(known: Head, theirs: Layout, own: Layout) -> tuple[Wrinkles, Image]:
    """The built-in head's maps of wrinkles and of segments, in a layout of another mesh's own.

    theirs: where the same triangles lie in the built-in layout.
    """
    texels = texels_within(own, (SIZE, SIZE))
    place = texels.interpolate(theirs.corners)
    segments = np.full((SIZE, SIZE), Segment.SKIN, np.uint8)
    segments[texels.rows, texels.columns] = sampled(known.segments, place)
    found = sampled(known.wrinkles.map, place)
    sides, their_sides = (np.diff(each.corners, axis=1) for each in (own, theirs))  # (F, 2, 2)
    is_flat = abs(np.linalg.det(sides)) < 1e-14
    sides[is_flat] = np.eye(2)
    change = np.linalg.solve(sides, their_sides)  # row i: theirs over a step along own axis i
    slope = (found[:, :2] - 128.0) * (known.wrinkles.steepest / 127.0)
    slope = np.einsum("nij,nj->ni", change[texels.faces], slope)
    steepest = max(float(np.percentile(abs(slope), STEEPEST)), 1e-6) if len(slope) else 1.0
    wrinkles = np.full((SIZE, SIZE, 4), (128, 128, 0, 0), np.uint8)
    level = (128.0 + slope * (127.0 / steepest)).round().clip(1, 255).astype(np.uint8)
    wrinkles[texels.rows, texels.columns] = np.column_stack([level, found[:, 2:]])
    relief = np.zeros((SIZE, SIZE, 2), np.int8)
    relief[texels.rows, texels.columns] = _between_texels(known.wrinkles.relief, place)
    return replace(known.wrinkles, map=wrinkles, steepest=steepest, relief=relief), segments


def own_picture(
    texture: Texture, faces: npt.NDArray[np.int64], turned: bool
) -> tuple[Image, Layout] | None:
    """The picture of some triangles and where they lie in it; None where they have none.

    Several pictures become one, side by side; what has none takes the mean of the others' colours.
    turned: whether the corners of these triangles are to be in the other order.
    """
    import PIL.Image  # which to load a head takes no time for

    numbers = texture.picture[faces]
    used = np.unique(numbers)
    if used.max() < 0:
        return None
    pictures = [texture.pictures[each]() for each in used if each >= 0]
    if used[0] < 0:
        mean = np.mean([each.mean(axis=(0, 1)) for each in pictures], axis=0)
        pictures.insert(0, np.full((1, 1, 3), mean.round(), np.uint8))
    width = min(max(each.shape[1] for each in pictures), LARGEST // len(pictures))
    height = max(each.shape[0] for each in pictures)
    if len(pictures) > 1:
        tiles = [np.asarray(PIL.Image.fromarray(p).resize((width, height))) for p in pictures]
        pictures = [np.hstack(tiles)]
    corners = texture.uv.astype(np.float64)[texture.face_uv[faces]]
    corners -= np.floor(corners.mean(axis=1, keepdims=True))  # pictures repeat
    corners = corners.clip(0.0, 1.0)
    corners[..., 0] = (corners[..., 0] + np.searchsorted(used, numbers)[:, None]) / len(used)
    uv, number = np.unique(corners.reshape(-1, 2).astype(np.float32), axis=0, return_inverse=True)
    face_uv = number.reshape(-1, 3).astype(np.int32)
    return pictures[0], Layout(uv, np.ascontiguousarray(face_uv[:, ::-1] if turned else face_uv))
