"""Give another head texture coordinates in the built-in texture, or maps for its own texture.

A vertex takes the texture coordinates of its foot, the nearest point on the warped built-in skin.
This is right on a face, but wrong where one head has folds that the other lacks: in nostrils,
behind ears, in the mouth. So a farther foot gets a smaller weight, and a foot on an ear or in a
nostril gets none. Springs spread vertices without weight evenly between the others. Because the
border of such a patch is fixed, the patch does not overlap itself (Tutte 1963, "How to draw a
graph").

A mesh with a texture keeps its texture coordinates. The maps of the built-in head (wrinkles, and
segments such as nose and lips) are then drawn again, texel by texel, in the layout of this texture.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from scipy import sparse
from scipy.sparse.linalg import cg

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32, Integers64, Unsigned8
from ...geometry.closest import SurfacePoints
from ...geometry.directions import unit_vectors
from ...geometry.normals import cross_products
from ...geometry.sides import edges_of, side_lengths
from ...geometry.steps import smoothstep
from ...geometry.texels import Texels, rates
from ..data_files import Image, read_arrays, read_image
from ..errors import AssetError
from ..model import Head, Segment, Wrinkles
from ..pictures import LARGEST_SIDE, MeshPictures
from .mesh_validation import SkinPiece

MAP_SIZE = 1024  # [texels] width and height of maps that are drawn again


def spread_uv(
    known: Head,
    warped: Floats64,
    nearest: SurfacePoints,
    skin: tuple[Floats64, Floats64, Integers32],
    holds: Floats64 | float = 1.0,
) -> Floats32:
    """Find texture coordinates in the built-in texture for another head's vertices, (V, 2).

    warped: vertices of the built-in skin after the warp [mm], (n, 3). nearest: foot of each vertex
    on this skin. skin: the other head's vertices (V, 3) [mm], unit normals (V, 3) and faces (F, 3).
    holds: factor on the force that holds a vertex at its foot, (V,) or a number.
    """
    vertices, normals, faces = skin
    feet = nearest.interpolate(warped)
    away = np.linalg.norm(feet - vertices, axis=1)
    across = cross_products(warped, nearest.corners)
    across = unit_vectors(across)
    trusted_within = 6.0  # [mm]; at this distance from its foot, the trust of a vertex is half
    trust = 1.0 / (1.0 + (away / trusted_within) ** 2)
    least_cosine = 0.3  # between the normals of a vertex and its foot
    trust[(across * normals).sum(axis=1) < least_cosine] = 0.0
    is_folded = read_arrays(known.file_beside("_plain.npz"))["is_folded"]  # on ears and in nostrils
    trust[nearest.interpolate(is_folded.astype(np.float64)) > 0.3] = 0.0
    # Necks and shoulders below the built-in head have their feet on its rim.
    rim = np.concatenate([known.rings["rim_left"], known.rings["rim_right"]])
    is_on_rim = np.zeros(len(known.vertices))
    is_on_rim[rim] = 1.0
    on_rim = nearest.interpolate(is_on_rim)
    count = len(vertices)
    links = edges_of(faces)
    is_behind = is_behind_others(feet, vertices, links)
    trust[is_behind & (on_rim < 0.99)] = 0.0
    # Shorter edges are stiffer. With equal stiffness, short and long edges would become equally
    # long in the texture.
    lengths = side_lengths(vertices, links)
    least_distance = 0.05  # [mm]; limits the stiffness between close neighbours
    stiffness = 1.0 / np.maximum(lengths, least_distance)
    linked = sparse.coo_array((stiffness, links.T), shape=(count, count))
    linked = linked + linked.T
    degree = linked.sum(axis=0)
    neighbour = degree / np.maximum(np.bincount(links.ravel(), minlength=count), 1)
    weakest = 4.0  # stiffness of a hold relative to edges, before trust scales it
    strongest = 12.0
    strength = weakest + (strongest - weakest) * trust
    least_trust = 1e-6  # above 0, so that the system has a solution for every vertex
    hold = holds * neighbour * strength * np.maximum(trust, least_trust)
    system = (sparse.diags_array(degree + hold) - linked).tocsr()
    start = nearest.interpolate(known.uv)
    scale = sparse.diags_array(1.0 / (degree + hold))
    tolerance = 1e-5
    most_rounds = 1000
    columns = [
        cg(system, hold * each, x0=each, M=scale, rtol=tolerance, maxiter=most_rounds)[0]
        for each in start.T
    ]
    return np.stack(columns, axis=1).astype(np.float32)


def is_behind_others(feet: Floats64, vertices: Floats64, links: Integers64) -> Flags:
    """Whether another part of the skin has the same foot as a vertex, and lies nearer to it, (V,).

    feet: foot of each vertex, (V, 3). links: edges, (E, 2). Midpoints of long edges also count,
    because the vertices of a coarse skin are too far apart to separate a nostril from the nose
    around it.
    """
    # [mm]; competing vertices are farther apart than this, and their feet nearer.
    competing_distance = 2.0
    long_edges = links[side_lengths(vertices, links) > competing_distance]
    all_feet = np.vstack([feet, feet[long_edges].mean(axis=1)])
    places = np.vstack([vertices, vertices[long_edges].mean(axis=1)])
    away = np.linalg.norm(all_feet - places, axis=1)
    competing_feet = 24
    distance, beside = scipy.spatial.cKDTree(all_feet).query(
        feet, k=min(competing_feet, len(all_feet))
    )
    apart = np.linalg.norm(places[beside] - vertices[:, None], axis=2)
    is_other = apart > distance + competing_distance
    has_same_foot = distance < competing_distance
    is_nearer = away[beside] < away[: len(feet), None] - 0.5 * competing_distance
    is_behind: Flags = (is_other & has_same_foot & is_nearer).any(axis=1)
    return is_behind


def plain_picture(known: Head) -> Image:
    """Return the built-in albedo without ears, nostrils and distinct strands of hair.

    Ears and nostrils of another head lie elsewhere; its shape and the light show them. The package
    has their texels as data; `plain_picture` of revision c11b6d62 drew them.
    """
    drawn = read_arrays(known.file_beside("_plain.npz"))
    picture = known.albedo.copy()
    picture[drawn["is_drawn"]] = drawn["colours"]
    return _with_even_hair(known, picture)


def plain_light(known: Head) -> Image:
    """Return the built-in ambient occlusion without ears and nostrils, as `plain_picture` does."""
    drawn = read_arrays(known.file_beside("_plain.npz"))
    light = known.ambient_occlusion.copy()
    light[drawn["is_lit"]] = drawn["light"]
    return light


def _with_even_hair(known: Head, picture: Image) -> Image:
    """Reduce the contrast of strands in a texture, in the hair and along the hairline.

    The strands follow the facets of the built-in scalp, so they are wavy on other heads.
    """
    import PIL.Image  # here, because most heads do not need it
    import PIL.ImageFilter

    kept = 0.25  # fraction of the contrast
    softened = PIL.ImageFilter.GaussianBlur(12.0)  # [texels], wider than a strand
    is_hair = known.segments == Segment.HAIR
    rows = slice(0, np.flatnonzero(is_hair.any(axis=1))[-1] + 1)
    mask = PIL.Image.fromarray(255 * is_hair[rows].astype(np.uint8))
    share = np.asarray(mask.filter(softened)) / 255.0
    near = picture[rows].astype(np.float32)
    mean = np.asarray(PIL.Image.fromarray(picture[rows]).filter(softened))
    strength = (1.0 - kept) * smoothstep(share, 0.05, 0.4)[:, :, None]
    even = picture.copy()
    even[rows] = (near + strength * (mean - near)).round()
    return even


def own_skin(known: Head, skin: SkinPiece) -> tuple[Image, Image]:
    """Return plain albedo and ambient occlusion for another head, with vertices in the face space.

    Triangles of a coarse lid reach across its edge, and would show a part of the dark line of
    lashes as a patch that looks like a hole. So coarse lids have no line.
    """
    picture = plain_picture(known)
    links = edges_of(skin.faces)
    upper_lids = skin.landmarks[[37, 38, 43, 44]]
    is_at_lid = np.isin(links, upper_lids).any(axis=1)
    lengths = side_lengths(skin.vertices, links[is_at_lid])
    coarse_lid_edge = 3.5  # [mm], mean of the edges at the landmarks of the upper lids
    if lengths.mean() > coarse_lid_edge:
        picture = _without_lash_roots(known, picture)
    return picture, plain_light(known)


def _without_lash_roots(known: Head, picture: Image) -> Image:
    """Replace the dark lines of lashes' roots in the built-in texture by the skin around."""
    roots = read_image(known.file_beside("_lids.png"), mode="L") / 255.0
    root_rows = np.flatnonzero(roots.any(axis=1))
    margin = 30  # [texels] above and below the roots
    rows = slice(root_rows[0] - margin, root_rows[-1] + margin)
    share = np.minimum(5.0 * roots[rows, :, None], 1.0)
    near = picture[rows].astype(np.float64)
    is_skin = share == 0.0
    size = 5.0  # [texels] of the Gaussian that fills the lines
    spread = (size, size, 0.0)
    colour_sums = scipy.ndimage.gaussian_filter(near * is_skin, spread)
    weights = scipy.ndimage.gaussian_filter(is_skin.astype(np.float64), spread)
    skin_colours = colour_sums / np.maximum(weights, 1e-6)
    filled = near + share * (skin_colours - near)
    drawn = picture.copy()
    drawn[rows] = filled.round().clip(0, 255).astype(np.uint8)
    return drawn


@dataclass(frozen=True)
class TextureLayout:
    """The layout of triangles in a texture.

    uv: texture coordinates, (U, 2). face_uv: rows of `uv` at the corners of triangles, (F, 3).
    """

    uv: Floats32
    face_uv: Integers32

    @property
    def corners(self) -> Floats64:
        """Texture coordinates of the corners of each triangle, (F, 3, 2)."""
        return self.uv.astype(np.float64)[self.face_uv]


def texels_within(layout: TextureLayout, size: tuple[int, int]) -> Texels:
    """Find the texels that triangles cover in a texture of (height, width), and a margin of 1.

    If triangles cover the texture many times over, raises AssetError.
    """
    try:
        return Texels.within(layout.corners, size, margin=1.0)  # colours blend across edges
    except ValueError:
        raise AssetError(
            "its texture coordinates cover the texture many times over; unwrap it again, or remove "
            "its materials"
        ) from None


def sampled(picture: Unsigned8, uv: Floats64) -> Unsigned8:
    """Return the texels (n, C) of a texture (H, W, C) at texture coordinates (n, 2)."""
    height, width = picture.shape[:2]
    places = uv * [width, -height] + [0.0, height]  # v runs upward, and rows run downward
    columns, rows = np.floor(places).astype(np.int64).T
    found: Unsigned8 = picture[rows.clip(0, height - 1), columns.clip(0, width - 1)]
    return found


def drawn_over(
    picture: Image, layout: TextureLayout, colours: Floats64 | tuple[Image, TextureLayout]
) -> Image:
    """Draw the triangles of a layout over a texture (H, W, ...), uint8.

    colours: colour of each corner, 0 to 255, (F, 3, 3); or a pair of another texture and the layout
    of the triangles in this texture.
    """
    texels = texels_within(layout, picture.shape[:2])
    if isinstance(colours, tuple):
        found = sampled(colours[0], texels.interpolate(colours[1].corners))
    else:
        found = texels.interpolate(colours).round().clip(0, 255).astype(np.uint8)
    drawn = picture.copy()
    drawn[texels.rows, texels.columns] = found
    return drawn


def maps_in(
    known: Head,
    theirs: TextureLayout,
    own: TextureLayout,
    size: tuple[int, int] = (MAP_SIZE, MAP_SIZE),
) -> tuple[Wrinkles, Image, Image]:
    """Draw the built-in wrinkles, segments and ambient occlusion in the layout of another mesh.

    theirs: layout of the mesh's triangles in the built-in texture. own: layout in the mesh's own
    texture. size: (H, W) of this texture and of the returned ambient occlusion.
    """
    import PIL.Image  # here, because most heads do not need it

    texels = texels_within(own, (MAP_SIZE, MAP_SIZE))
    place = texels.interpolate(theirs.corners)
    segments = np.full((MAP_SIZE, MAP_SIZE), Segment.SKIN, np.uint8)
    segments[texels.rows, texels.columns] = sampled(known.segments, place)
    light = np.full((MAP_SIZE, MAP_SIZE), 255, np.uint8)
    light[texels.rows, texels.columns] = sampled(plain_light(known), place)
    found = sampled(known.wrinkles.map, place)
    slope = _slopes_in(known, found, theirs, own, texels)
    steepest_percentile = 99.9  # [%] of slopes that are not clipped
    steepest = 1.0
    if len(slope):
        steepest = max(float(np.percentile(abs(slope), steepest_percentile)), 1e-6)
    wrinkles = np.full((MAP_SIZE, MAP_SIZE, 4), (128, 128, 0, 0), np.uint8)
    wrinkles[texels.rows, texels.columns] = _wrinkle_texels(slope, steepest, found)
    light = np.asarray(PIL.Image.fromarray(light).resize(size[::-1]))
    return replace(known.wrinkles, map=wrinkles, steepest=steepest), segments, light


def maps_over(
    known: Head, theirs: TextureLayout, own: TextureLayout
) -> tuple[Wrinkles, Image, Image]:
    """Draw triangles of the built-in wrinkles, segments and ambient occlusion at other places.

    theirs: layout of the triangles in the built-in maps. own: layout of the places where they are
    drawn over the same maps.
    """
    light = plain_light(known)
    segments = drawn_over(known.segments, own, (known.segments, theirs))
    texels = texels_within(own, known.wrinkles.map.shape[:2])
    found = sampled(known.wrinkles.map, texels.interpolate(theirs.corners))
    slope = _slopes_in(known, found, theirs, own, texels)
    wrinkles = known.wrinkles.map.copy()
    wrinkles[texels.rows, texels.columns] = _wrinkle_texels(slope, known.wrinkles.steepest, found)
    return (
        replace(known.wrinkles, map=wrinkles),
        segments,
        drawn_over(light, own, (light, theirs)),
    )


def _slopes_in(
    known: Head, found: Unsigned8, theirs: TextureLayout, own: TextureLayout, texels: Texels
) -> Floats64:
    """Return slopes along u and v of the layout `own` at its texels, (n, 2).

    found: texels of the built-in wrinkles there, (n, 4), with slopes along u and v of `theirs`.
    """
    of_corners = _rates_at_corners(theirs, own)[own.face_uv]
    change = texels.interpolate(of_corners).reshape(-1, 2, 2)
    slope = (found[:, :2] - 128.0) * (known.wrinkles.steepest / 127.0)
    changed: Floats64 = np.einsum("nij,nj->ni", change, slope)
    return changed


def _wrinkle_texels(slope: Floats64, steepest: float, known: Unsigned8) -> Unsigned8:
    """Return texels of a map of wrinkles, (n, 4), with other slopes than `known` texels, (n, 4).

    slope: new slopes along u and v, (n, 2). The byte 255 stands for the slope `steepest`.
    """
    values = 128.0 + slope * (127.0 / steepest)
    levels = values.round().clip(1, 255).astype(np.uint8)
    return np.column_stack([levels, known[:, 2:]])


def _rates_at_corners(theirs: TextureLayout, own: TextureLayout) -> Floats64:
    """Return derivatives of the built-in layout by another layout, at rows of its `uv`, (U, 4).

    They are means over the surrounding triangles, weighted by area. Derivatives of single triangles
    jump at edges, which would break a furrow into pieces.
    """
    corners = own.corners
    edges = corners[:, 1:] - corners[:, :1]
    area = np.abs(np.linalg.det(edges))
    weighted = area[:, None] * rates(corners, theirs.corners).reshape(-1, 4)
    rows = own.face_uv.ravel()

    def sums_around(values: Floats64) -> Floats64:
        """Sum values of triangles (F,) at the rows of `uv` that are their corners, (U,)."""
        return np.asarray(np.bincount(rows, np.repeat(values, 3), len(own.uv)), np.float64)

    sums = np.column_stack([sums_around(column) for column in weighted.T])
    areas = np.maximum(sums_around(area), 1e-30)
    means: Floats64 = sums / areas[:, None]
    return means


def own_picture(
    texture: MeshPictures, faces: Integers64, turned: bool
) -> tuple[Image, TextureLayout] | None:
    """Return the texture of some triangles, and their layout; None if they have no texture.

    Several textures are put side by side into one. Triangles without a texture get the mean colour.
    faces: indices of the triangles, (F,). turned: whether to reverse the corners of each triangle.
    """
    import PIL.Image  # here, because most heads do not need it

    numbers = texture.picture[faces]
    used = np.unique(numbers)
    if used.max() < 0:
        return None
    pictures = [texture.pictures[each]() for each in used if each >= 0]
    if used[0] < 0:
        mean = np.mean([each.mean(axis=(0, 1)) for each in pictures], axis=0)
        pictures.insert(0, np.full((1, 1, 3), mean.round(), np.uint8))
    height = max(picture.shape[0] for picture in pictures)
    widest = max(picture.shape[1] for picture in pictures)
    width = min(widest, LARGEST_SIDE // len(pictures))
    if len(pictures) > 1:
        tiles = [
            np.asarray(PIL.Image.fromarray(picture).resize((width, height))) for picture in pictures
        ]
        pictures = [np.hstack(tiles)]
    corners = texture.uv.astype(np.float64)[texture.face_uv[faces]]
    corners -= np.floor(corners.mean(axis=1, keepdims=True))  # texture coordinates wrap around
    corners = corners.clip(0.0, 1.0)
    tile = np.searchsorted(used, numbers)
    corners[..., 0] = (corners[..., 0] + tile[:, None]) / len(used)
    rows = corners.reshape(-1, 2).astype(np.float32)
    uv, number = np.unique(rows, axis=0, return_inverse=True)
    face_uv = number.reshape(-1, 3).astype(np.int32)
    if turned:
        face_uv = np.ascontiguousarray(face_uv[:, ::-1])
    return pictures[0], TextureLayout(uv, face_uv)
