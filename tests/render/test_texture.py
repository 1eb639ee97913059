"""Skin from a picture: its place, its brightness, and the layers over it."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from risorius import render
from risorius.render.texture import (
    _first_halved,
    _halved_image,
    _linear_values,
    _lit_texels,
    _square_roots,
)

from .scenes import PLAIN_STYLE, at, draw, draw_image, lent, sphere, square, turned_over


def textured(
    surface,
    image,
    style=PLAIN_STYLE,
    *,
    shape=None,
    values=None,
    occlusion=None,
    fine_shape=None,
    oil=None,
    corner=None,
):
    """The picture of a square (or another shape) with the image spanning x and y from -50 to 50.

    corner: the texture coordinates of the lower right vertex, if it lies elsewhere.
    """
    shape = shape or square()
    renderer = render.Renderer(surface)
    stream = lent(renderer, shape, columns=16 if fine_shape else 8)
    stream.vertices[:, 6:8] = shape.positions[:, :2] / 100.0 + 0.5
    if corner is not None:
        stream.vertices[1, 6:8] = corner
    if fine_shape:
        stream.vertices[:, 8:] = 0.0
        stream.vertices[:, [10, 14]] = 0.01  # u grows along x, v along y
    stream.upload(len(shape.positions), len(shape.triangles))
    fine = None if fine_shape is None else renderer.bump_map(*fine_shape, channels=2)
    texture = render.SkinTexture(renderer.surface, image, occlusion, fine, oil)
    skin = render.Skin(stream, render.SkinMaps(texture), values=values)
    return draw(renderer, skin, style)


def plain_image(colour, size=(8, 8)):
    """An image of one colour."""
    return np.full((size[1], size[0], 3), colour, np.uint8)


def quarters():
    """An image: red up left, green up right, blue down left, grey down right."""
    image = np.zeros((48, 64, 3), np.uint8)
    image[:24, :32] = (200, 30, 30)
    image[:24, 32:] = (30, 200, 30)
    image[24:, :32] = (30, 30, 200)
    image[24:, 32:] = (90, 90, 90)
    return image


@pytest.mark.parametrize("shading", render.Shading)
@pytest.mark.parametrize("wireframe", [False, True])
def test_top_row_lies_at_v_1(surface, shading, wireframe):
    """The image's top row lies at v = 1, not mirrored, in every shading."""
    frame = textured(
        surface, quarters(), replace(PLAIN_STYLE, shading=shading, wireframe=wireframe)
    )
    assert frame[24, 24].argmax() == 0
    assert frame[24, 24, 0] > 150 > frame[24, 24, 1]
    assert frame[24, 72].argmax() == 1
    assert frame[24, 72, 1] > 150 > frame[24, 72, 2]
    assert frame[72, 24].argmax() == 2
    assert frame[72, 24, 2] > 150 > frame[72, 24, 0]
    assert np.ptp(frame[72, 72]) < 30


@pytest.mark.parametrize("level", [20, 128, 230])
def test_grey_texture_is_the_grey_albedo(surface, level):
    """A grey texture gives the same picture as an equal albedo, because sRGB is decoded."""
    albedo = (level / 255.0,) * 3
    style = replace(PLAIN_STYLE, gloss=0.0, albedo=albedo)  # highlights depend on the picture
    expected = draw_image(surface, sphere(3), style)
    frame = textured(surface, plain_image((level,) * 3), style, shape=sphere(3))
    assert np.abs(frame - expected).max() <= 2
    assert (
        np.abs(draw_image(surface, sphere(3), replace(style, albedo=render.SKIN)) - expected).max()
        > 20
    )


def test_texture_is_filtered_in_linear_light(surface):
    """From afar, a fine checker of black and white is as bright as its mean light: sRGB 188."""
    rows, columns = np.indices((512, 512))
    checker = np.repeat(((rows + columns) % 2 * 255).astype(np.uint8)[:, :, None], 3, axis=2)
    frame = textured(surface, checker)[30:66, 30:66]
    expected = textured(surface, plain_image((188, 188, 188)))[30:66, 30:66]
    assert np.abs(frame - expected).max() <= 4


@pytest.mark.parametrize("size", [(6, 4), (7, 5), (1, 6), (5, 1)])
def test_smaller_versions_are_means_of_blocks(size):
    """Smaller versions leave out a last row or column without a partner.

    A single row or column is kept.
    """
    values = np.random.default_rng(0).random((*size, 4), np.float32)
    height, width = (max(count // 2, 1) for count in size)
    tall, wide = (min(count, 2) for count in size)
    whole = values[: tall * height, : wide * width].astype(np.float64)
    means = whole.reshape(height, tall, width, wide, 4).mean(axis=(1, 3))
    assert _halved_image(values) == pytest.approx(means, abs=1e-6)


@pytest.mark.parametrize("size", [(6, 4), (7, 5), (1, 6), (5, 1), (1, 1)])
@pytest.mark.parametrize("is_shaded", [False, True])
def test_compiled_texels_are_those_of_whole_arrays(size, is_shaded):
    """The kernels give each texel, and the first smaller version, the bits of numpy's result."""
    random = np.random.default_rng(1)
    image = random.integers(0, 256, (*size, 3), np.uint8)
    occlusion = random.integers(0, 256, size if is_shaded else (1, 1), np.uint8)
    places = np.empty((*size, 4), np.intp)
    places[..., :3] = image
    places[..., 3] = 256 + occlusion.astype(np.intp)
    values = _linear_values()
    assert (_lit_texels(image, occlusion) == _square_roots(values)[places]).all()
    assert (_first_halved(image, occlusion) == _halved_image(values[places])).all()


def test_untextured_style_is_the_plain_picture(surface):
    """With textured=False a texture changes no pixel; without texture, `textured` does not."""
    style = replace(PLAIN_STYLE, textured=False)
    expected = draw_image(surface, square(), PLAIN_STYLE)
    assert (textured(surface, quarters(), style) == expected).all()
    assert (draw_image(surface, square(), style) == expected).all()
    assert (textured(surface, quarters()) != expected).any()


@pytest.mark.parametrize("shading", render.Shading)
def test_splits_tint_the_texture(surface, shading):
    """Unsplit triangles stay textured; the others have the palette's hue over the texture."""
    style = replace(PLAIN_STYLE, shading=shading)
    counted = replace(style, colour_by=render.ColourBy.SPLITS)
    image = quarters()
    frame = textured(surface, image, counted, values=np.array([0, 4], np.uint8))
    without = textured(surface, image, style)
    lower = (72, 84)  # row and column of a point below the diagonal; the next is above
    upper = (12, 24)
    assert (frame[lower] == without[lower]).all()
    assert frame[upper][2] > frame[upper][0] + 40  # red without the tint
    assert without[upper][0] > without[upper][2] + 100
    other_side = frame[12, 60]  # green without the tint: the picture shows through
    assert np.abs(other_side - frame[upper]).max() > 15


def test_lips_gloss(surface):
    """Texels much redder than most of the picture shine more than the gloss of skin."""
    lips = plain_image((212, 176, 160), (256, 256))
    lips[64:192, 64:192] = (200, 120, 108)
    shine = {}
    for name, image in (("lips", lips), ("all lips", plain_image((200, 120, 108), (256, 256)))):
        frames = [
            textured(surface, image, replace(PLAIN_STYLE, gloss=gloss), shape=square(bulge=0.4))
            for gloss in (0.0, 1.0)
        ]
        shine[name] = int((frames[1] - frames[0])[46:50, 46:50].sum())
    assert shine["lips"] > 1.5 * shine["all lips"] > 0


def test_skin_without_oil_is_dull(surface):
    """The highlight follows the map of oil: the dry left half has none, the oily right half all."""
    image = plain_image((212, 176, 160), (256, 256))
    half = np.tile(np.uint8([0, 255]), (2, 1)).repeat(8, axis=1)
    shine = {}
    for name, oil in (("half", half), ("full", None)):
        frames = [
            textured(
                surface, image, replace(PLAIN_STYLE, gloss=gloss), shape=square(bulge=0.4), oil=oil
            )
            for gloss in (0.0, 1.0)
        ]
        shine[name] = (frames[1] - frames[0]).astype(int)
    assert shine["full"][30:66, 20:40].max() > 5
    assert not shine["half"][30:66, 20:40].any()
    assert (shine["half"][30:66, 60:76] == shine["full"][30:66, 60:76]).all()


def test_skin_between_dark_hairs_shines_like_bare_skin(surface):
    """The highlight on skin between stubble is at most half as strong again as on bare skin."""
    skin = plain_image((112, 78, 62), (256, 256))
    stubble = skin.copy()
    stubble.reshape(16, 16, 16, 16, 3)[4:12, :8, 4:12] = (20, 16, 14)
    shine = {}
    for name, image in (("skin", skin), ("stubble", stubble)):
        frames = [
            textured(surface, image, replace(PLAIN_STYLE, gloss=gloss), shape=square(bulge=0.4))
            for gloss in (0.0, 0.4)
        ]
        shine[name] = (frames[1] - frames[0])[30:66, 30:66].astype(int)
    assert 0 < shine["stubble"].max() < 1.5 * shine["skin"].max()


def test_back_faces_keep_the_inner_albedo(surface):
    """The texture lies on the outside only; back faces have the inner albedo."""
    shape = square()
    turned = turned_over(shape)
    blue = textured(surface, plain_image((0, 0, 255)), shape=turned)
    assert (blue == draw_image(surface, turned))[20:76, 20:76].all()


def test_texture_needs_eight_columns(renderer):
    """A stream without texture coordinates is refused for a texture."""
    stream = lent(renderer, square())
    texture = render.SkinTexture(renderer.surface, quarters())
    with pytest.raises(ValueError, match="a texture meets a stream of 6 columns; it needs texture"):
        render.Skin(stream, render.SkinMaps(texture))


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros((4, 4), np.uint8), r"shape \(4, 4\) and dtype uint8; it must be \(height, width"),
        (np.zeros((4, 4, 4), np.uint8), r"shape \(4, 4, 4\)"),
        (np.zeros((4, 4, 3), np.float32), "dtype float32"),
        (np.zeros((0, 4, 3), np.uint8), r"shape \(0, 4, 3\)"),
        (np.zeros((1, 100_000, 3), np.uint8), "100000 x 1 texels; this driver takes at most"),
    ],
)
def test_bad_images(surface, image, message):
    """Images that are not 8-bit RGB, or are too large, are refused."""
    with pytest.raises(ValueError, match=message):
        render.SkinTexture(surface, image)


def test_occlusion_of_another_size_is_refused(surface):
    """Ambient occlusion needs the size of the image, beyond which memory would be read."""
    with pytest.raises(ValueError, match=r"occlusion has shape \(4, 4\); it must be \(8, 8\)"):
        render.SkinTexture(surface, plain_image((180, 140, 120)), np.zeros((4, 4), np.uint8))


@pytest.mark.parametrize("shading", render.Shading)
def test_less_light_where_it_is_less_open(surface, shading):
    """The texture's ambient occlusion darkens light from all sides, not the key light."""
    image = plain_image((180, 140, 120))
    occlusion = np.full((8, 8), 255, np.uint8)
    occlusion[:, :4] = 128
    occlusion[4:, :4] = 0
    style = replace(PLAIN_STYLE, shading=shading)
    plain = textured(surface, image, style)
    folded = textured(surface, image, style, occlusion=occlusion)
    height, width = plain.shape[:2]
    lost = (plain - folded)[..., 1]
    right = np.s_[height // 4, 5 * width // 8]
    upper = np.s_[3 * height // 8, 3 * width // 8]
    lower = np.s_[5 * height // 8, 3 * width // 8]
    assert lost[right] == 0
    assert 5 < lost[upper] < lost[lower]
    assert folded[lower].min() > 20  # the key light is still there
    off = textured(surface, image, replace(style, skin_maps=False), occlusion=occlusion)
    assert np.array_equal(off, plain)


@pytest.mark.parametrize("shading", render.Shading)
@pytest.mark.parametrize("is_textured", [True, False])
def test_fine_shape_tilts_the_normal_of_each_pixel(surface, shading, is_textured):
    """Slopes that rise to the right are brighter; level skin and other shadings are unchanged."""
    slopes = np.full((32, 32, 2), 128, np.uint8)
    slopes[:, 16:] = 190, 128
    image = plain_image((180, 140, 120))
    style = replace(PLAIN_STYLE, shading=shading)
    style = replace(style, textured=is_textured)
    plain = textured(surface, image, style)
    shown = textured(surface, image, style, fine_shape=(slopes, 100.0))
    off = textured(surface, image, replace(style, skin_maps=False), fine_shape=(slopes, 100.0))
    assert np.array_equal(off, plain)
    if shading is not render.Shading.PIXEL:
        assert np.array_equal(shown, plain)
        return
    middle = plain.shape[1] // 2
    assert np.array_equal(shown[:, : middle - 2], plain[:, : middle - 2])
    assert (shown - plain)[48, middle + 20].sum() > 10


def test_fine_shape_does_not_jump_between_unequal_triangles(surface):
    """A constant slope is lit alike on two triangles of which one is stretched."""
    slopes = np.full((32, 32, 2), 128, np.uint8)
    slopes[..., 0] = 190
    image = plain_image((180, 140, 120))
    shown = textured(surface, image, fine_shape=(slopes, 100.0), corner=(0.6, 0.4))
    beside = np.abs(at(shown, 5, -5) - at(shown, -5, 5))
    across = np.abs(at(shown, 10, 0) - at(shown, 5, -5))
    assert beside.max() <= across.max() + 2


def test_fine_shape_that_is_none_is_refused(surface):
    """A map of wrinkles is refused as a map of fine shape."""
    with pytest.raises(ValueError, match=r"the fine shape has shape \(4, 4, 4\)"):
        render.BumpMap(surface, np.zeros((4, 4, 4), np.uint8), 1.0, 2)


def test_maps_are_uploaded_once(surface):
    """Maps of wrinkles and pores are shared between persons; unused ones are freed."""
    renderer = render.Renderer(surface)
    texels = np.full((8, 8, 4), 128, np.uint8)
    first = renderer.bump_map(texels, 1.0)
    assert renderer.bump_map(texels, 1.0) is first
    assert renderer.bump_map(texels.copy(), 1.0) is not first
    assert renderer.bump_map(texels, 2.0) is not first
    gone = weakref.ref(first)
    del first
    gc.collect()
    assert gone() is None
