"""Draw calls: shading, wireframe, colours, viewports, parts, lines, shadows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

import render

from .scenes import PLAIN, Ball, Shape, drawn, facing, joined, lent, picture, sphere, square

FLAT = replace(PLAIN, shading=render.Shading.FLAT)
GOURAUD = replace(PLAIN, shading=render.Shading.GOURAUD)
SPLITS = replace(PLAIN, colour_by=render.ColourBy.SPLITS)
STILL = {"cranium": np.eye(4), "eye_left": np.eye(4)}

Frame = npt.NDArray[np.int32]


def at(frame: Frame, x: float, y: float) -> npt.NDArray[np.int32]:
    """The pixel that shows the point (x, y, 0) of `facing`'s view."""
    height, width, _ = frame.shape
    scale = 0.5 * height / (250.0 * np.tan(np.radians(12.5)))
    return np.asarray(frame[int(0.5 * height - y * scale), int(0.5 * width + x * scale)])


def test_three_shadings_differ(surface: render.Surface) -> None:
    """Flat, Gouraud and per-pixel lighting are three pictures of the same silhouette."""
    frames = [picture(surface, sphere(1), style) for style in (FLAT, GOURAUD, PLAIN)]
    for first in range(3):
        for second in range(first):
            difference = np.abs(frames[first] - frames[second])
            assert difference.mean() > 0.5
            assert (drawn(frames[first]) == drawn(frames[second])).mean() > 0.99


def test_flat_facets_have_one_colour(surface: render.Surface) -> None:
    """Flat shading gives a tilted triangle the same colour everywhere; Gouraud does not."""
    shape = square(bulge=1.0)
    tilted = Shape(shape.positions.copy(), shape.normals, shape.triangles[:1])
    tilted.positions[:, 2] = (0.0, 25.0, 5.0, 0.0)
    spread = {}
    for name, style in (("flat", FLAT), ("gouraud", GOURAUD)):
        frame = picture(surface, tilted, style)
        inner = frame[60:72, 56:72].reshape(-1, 3)
        spread[name] = int(np.ptp(inner, axis=0).max())
    assert spread["flat"] <= 1 < spread["gouraud"]


def test_flat_shading_ignores_vertex_normals(surface: render.Surface) -> None:
    """The geometric normal of the drawn triangle decides."""
    frames = [picture(surface, square(bulge=bulge), FLAT) for bulge in (0.0, 2.0)]
    assert (frames[0] == frames[1]).all()


def test_only_pixel_shading_lights_the_middle_of_a_facet(surface: render.Surface) -> None:
    """Between four corners that turn away, Gouraud stays as dark as they are."""
    shape = square(bulge=3.0)
    middle = {
        name: int(at(picture(surface, shape, style), 3.0, -1.0).sum())
        for name, style in (("gouraud", GOURAUD), ("pixel", PLAIN))
    }
    assert middle["pixel"] > middle["gouraud"] + 20


def test_light_comes_from_the_upper_left(surface: render.Surface) -> None:
    """The sphere is brightest up left of its middle, and its dark side is not black."""
    frame = picture(surface, sphere(4), replace(PLAIN, albedo=render.CLAY)).sum(axis=2)
    upper_left, lower_right = frame[32, 32], frame[64, 64]
    assert upper_left > 1.5 * lower_right
    assert lower_right > 3 * 30


def test_terminator_of_skin_is_warm(surface: render.Surface) -> None:
    """Where light fades out, skin is redder than its albedo; clay is not."""
    shares = {}
    for name, albedo in (("skin", render.SKIN), ("clay", render.CLAY)):
        style = replace(PLAIN, albedo=albedo, background=render.DARK)
        frame = picture(surface, sphere(4), style).astype(float)
        share = frame[:, :, 0] / frame.sum(axis=2)
        shares[name] = share[60, 60] - share[36, 36]
    assert shares["skin"] > shares["clay"] + 0.01


def test_inner_side_is_dark_flesh(surface: render.Surface) -> None:
    """Seen from behind, a surface is much darker, and red."""
    shape = square()
    turned = Shape(shape.positions, -shape.normals, shape.triangles[:, ::-1].copy())
    for style in (FLAT, GOURAUD, PLAIN):
        front = at(picture(surface, shape, style), 5.0, 5.0)
        behind = at(picture(surface, turned, style), 5.0, 5.0)
        assert behind.sum() < 0.4 * front.sum()
        assert behind[0] > 1.5 * behind[1] and behind[0] > 20


def test_wireframe_darkens_edges_only(surface: render.Surface) -> None:
    """Lines run along borders and diagonal; between them the surface is as before."""
    plain = picture(surface, square())
    wired = picture(surface, square(), replace(PLAIN, wireframe=True, wire_width=3.0))
    assert at(wired, 0.0, 0.0).sum() < 0.8 * at(plain, 0.0, 0.0).sum()
    assert at(wired, 49.5, 0.0).sum() < 0.9 * at(plain, 49.5, 0.0).sum()
    assert (at(wired, 20.0, -20.0) == at(plain, 20.0, -20.0)).all()
    changed = (np.abs(wired - plain) > 8).any(axis=2)
    assert 0.05 < changed.mean() < 0.2


def test_wireframe_is_as_wide_as_asked(surface: render.Surface) -> None:
    """A line of twice the width darkens about twice the pixels."""
    plain = picture(surface, square())
    loss = []
    for width in (1.0, 2.0):
        style = replace(PLAIN, wireframe=True, wire_width=width, wire_opacity=1.0)
        loss.append(float((plain - picture(surface, square(), style)).sum()))
    assert loss[1] / loss[0] == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("shading", render.Shading)
@pytest.mark.parametrize("wireframe", [False, True])
def test_split_colours_are_where_the_values_say(
    surface: render.Surface, shading: render.Shading, wireframe: bool
) -> None:
    """A triangle with splits has its palette's hue, its neighbour keeps the skin."""
    style = replace(SPLITS, shading=shading, wireframe=wireframe)
    frame = picture(surface, square(), style, values=np.array([0, 4], np.uint8))
    lower, upper = at(frame, 20.0, -20.0), at(frame, -20.0, 20.0)
    assert lower[0] > lower[2] + 20
    assert upper[2] > upper[0] + 60
    swapped = picture(surface, square(), style, values=np.array([4, 0], np.uint8))
    assert at(swapped, 20.0, -20.0)[2] > at(swapped, 20.0, -20.0)[0] + 60


def test_split_colours_of_many_triangles(surface: render.Surface) -> None:
    """Beyond one row of the look-up texture the numbers still belong to their triangles."""
    shape = sphere(5)
    centres = shape.positions[shape.triangles].mean(axis=1)
    values = np.where(centres[:, 1] > 0.0, 5, 0).astype(np.uint8)
    assert len(values) > 2 * 1024
    frame = picture(surface, shape, SPLITS, values=values)
    upper, lower = frame[30, 30:66], frame[66, 30:66]
    assert (upper[:, 2] > upper[:, 0]).all() and (lower[:, 0] > lower[:, 2]).all()


def test_palette_darkens_with_the_number_of_splits() -> None:
    """The order of the palette can be seen without colour: luminance falls at each step."""
    luminance = np.array(render.SPLIT_PALETTE) @ (0.2126, 0.7152, 0.0722)
    assert len(luminance) == 6 and (np.diff(luminance) < -0.08).all()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (None, "the style colours by values, so draw_mesh needs values"),
        (np.zeros(3, np.uint8), r"values has shape \(3,\) and dtype uint8; it must be \(2,\)"),
        (np.zeros(2, np.int32), r"dtype int32; it must be \(2,\) uint8"),
    ],
)
def test_split_values_must_fit(
    surface: render.Surface, values: npt.NDArray[np.uint8] | None, message: str
) -> None:
    """Missing or misshapen numbers are refused."""
    with pytest.raises(ValueError, match=message):
        picture(surface, square(), SPLITS, values=values)


@pytest.mark.parametrize("samples", [0, 4])
def test_viewports_are_apart(samples: int) -> None:
    """Drawing into the left half leaves every pixel of the right half as it was."""
    left, right, whole = (0, 0, 60, 50), (60, 0, 60, 50), (0, 0, 120, 50)
    with render.open_offscreen((120, 50), samples=samples) as surface:
        renderer = render.Renderer(surface)
        stream = lent(renderer, sphere())

        def draw(viewport: render.Viewport, style: render.Style, zoom: float) -> None:
            camera = facing()
            camera.zoom(zoom)
            renderer.draw_background(style, viewport)
            renderer.draw_mesh(stream, camera, style, viewport=viewport)
            renderer.draw_parts([Ball()], STILL, camera, style, viewport=viewport)
            renderer.draw_lines([stream.vertices[:9, :3]], (1, 0, 0), camera, viewport=viewport)

        surface.begin()
        draw(whole, render.Style(wireframe=True), 4.0)
        surface.end()
        before = surface.read()
        surface.begin()
        draw(whole, render.Style(wireframe=True), 4.0)
        draw(left, render.Style(background=render.DARK), 2.0)
        surface.end()
        after = surface.read()
        assert (after[:, 60:] == before[:, 60:]).all()
        assert (after[:, :60] != before[:, :60]).any(axis=2).mean() > 0.9

        surface.begin()
        draw(left, PLAIN, 1.0)
        draw(right, PLAIN, 1.0)
        surface.end()
        pair = surface.read()
        assert (pair[:, :60] == pair[:, 60:]).mean() > 0.99


def test_background_covers_what_was_drawn(surface: render.Surface) -> None:
    """An inset starts on an empty viewport: neither colours nor depth of before are left."""
    renderer = render.Renderer(surface)
    near, far = lent(renderer, square(z=40.0)), lent(renderer, square(z=-40.0))
    surface.begin()
    renderer.draw_background(PLAIN)
    renderer.draw_mesh(near, facing(), PLAIN)
    renderer.draw_background(PLAIN, (20, 20, 50, 50))
    renderer.draw_mesh(far, facing(), PLAIN, viewport=(20, 20, 50, 50))
    surface.end()
    inset = surface.read()[-70:-20, 20:70]
    assert (inset[:3] >= 254).all() and (inset[20:30, 20:30] < 250).any(axis=2).all()


def test_background_presets(surface: render.Surface) -> None:
    """Backgrounds are soft: bright or dark, never a step of more than two grey levels."""
    renderer = render.Renderer(surface)
    for background, low, high in ((render.LIGHT, 150, 240), (render.DARK, 10, 90)):
        surface.begin()
        renderer.draw_background(render.Style(background=background))
        surface.end()
        frame = surface.read().astype(int)
        assert low < frame.min() and frame.max() < high
        assert np.abs(np.diff(frame, axis=0)).max() <= 4


def test_viewport_must_have_pixels(surface: render.Surface) -> None:
    """A viewport without extent is refused."""
    with pytest.raises(ValueError, match=r"viewport is \(0, 0, 0, 10\); it must be"):
        render.Renderer(surface).draw_background(PLAIN, (0, 0, 0, 10))


def test_shadow_of_the_key_light(surface: render.Surface) -> None:
    """A small square before a wall darkens the wall to its lower right, and nowhere else."""
    blocker = square(12.0, z=30.0)
    thick = Shape(blocker.positions - (0, 0, 4), -blocker.normals, blocker.triangles[:, ::-1])
    shape = joined(square(), joined(blocker, thick))
    without = picture(surface, shape, replace(PLAIN, albedo=render.CLAY))
    within = picture(surface, shape, replace(PLAIN, albedo=render.CLAY, shadows=True))
    # The key stands at (-0.53, 0.63, 0.57): 28 mm before the wall are 26 mm right and 31 mm down.
    assert at(within, 26.0, -31.0).sum() < 0.8 * at(without, 26.0, -31.0).sum()
    assert at(within, 26.0, -31.0).min() > 40
    assert (at(within, -30.0, 30.0) == at(without, -30.0, 30.0)).all()
    assert (at(within, 0.0, 0.0) == at(without, 0.0, 0.0)).all()


def wall_in_shadow(style: render.Style) -> tuple[Frame, Frame]:
    """A wall with the shadow of a square, and without: the row 25 mm below the middle, x >= 0."""
    blocker = square(20.0, z=30.0)
    rows = []
    with render.open_offscreen((480, 480)) as surface:
        for shadows in (True, False):
            drawn_style = replace(style, shadows=shadows)
            frame = picture(surface, joined(square(), blocker), drawn_style)
            half_height = 250.0 * np.tan(np.radians(12.5))
            row = int(240.0 * (1.0 + 25.0 / half_height))
            right = int(240.0 * (1.0 + 49.0 / half_height))
            rows.append(frame[row, 240:right])
    return rows[0], rows[1]


def test_shadows_have_soft_edges() -> None:
    """From shadow to light the wall brightens steadily; on a head that takes 2 to 6 mm."""
    within, without = wall_in_shadow(replace(PLAIN, albedo=render.CLAY, subsurface=0.0))
    lightness = within.sum(axis=1) / without.sum(axis=1)
    darkest = int(lightness.argmin())
    edge = lightness[darkest:]
    assert edge[-1] > 0.99 and edge[0] < 0.75
    assert (np.diff(edge) > -0.01).all() and np.diff(edge).max() < 0.1
    share = (edge - edge[0]) / (edge[-1] - edge[0])
    pixel = 2.0 * 250.0 * np.tan(np.radians(12.5)) / 480.0
    on_a_head = pixel / facing().scene_radius * 150.0  # [mm]
    assert 2.0 < np.count_nonzero((share > 0.02) & (share < 0.98)) * on_a_head < 6.0


def test_shadow_on_skin_is_warm() -> None:
    """In the shadow skin is redder than in the light, and never grey or green."""
    within, without = wall_in_shadow(PLAIN)
    darkest = int(within.sum(axis=1).argmin())
    shadow, light = within[darkest].astype(float), without[darkest].astype(float)
    assert shadow[0] > 1.2 * shadow[1] > 1.2 * shadow[2]
    assert shadow[0] / shadow.sum() > light[0] / light.sum() + 0.01


@pytest.mark.parametrize("shading", render.Shading)
def test_convex_things_do_not_shadow_themselves(
    surface: render.Surface, shading: render.Shading
) -> None:
    """On a coarse sphere shadows change next to nothing: no stripes along the terminator."""
    style = replace(PLAIN, shading=shading)
    without = picture(surface, sphere(2), style)
    within = picture(surface, sphere(2), replace(style, shadows=True))
    assert np.abs(within - without).max() < 25 and np.abs(within - without).mean() < 0.7


def test_parts_move_with_their_bones(surface: render.Surface) -> None:
    """A part is drawn where the column-vector matrix of its bone puts it."""
    renderer = render.Renderer(surface)
    ball = Ball(bone="eye_left")
    places = []
    for x in (-25.0, 25.0):
        moved = np.eye(4)
        moved[:3, 3] = (x, 0.0, 0.0)
        surface.begin()
        renderer.draw_background(PLAIN)
        renderer.draw_parts([ball], {"eye_left": moved}, facing(), PLAIN)
        surface.end()
        frame = surface.read().astype(np.int32)
        assert at(frame, x, 0.0)[2] > at(frame, x, 0.0)[0] + 30
        places.append(np.nonzero(drawn(frame))[1].mean())
    assert places[0] == pytest.approx(47.5 - 21.5, abs=1.5)
    assert places[1] == pytest.approx(47.5 + 21.5, abs=1.5)


def test_wet_parts_have_a_crisp_highlight(surface: render.Surface) -> None:
    """Shine makes a few pixels nearly white, and leaves the others as they are."""
    renderer = render.Renderer(surface)
    frames = []
    for shine in (0.0, 1.0):
        surface.begin()
        renderer.draw_background(render.Style(background=render.DARK))
        renderer.draw_parts([Ball(shine=shine, colour=(0.1, 0.1, 0.1))], STILL, facing(25.0), PLAIN)
        surface.end()
        frames.append(surface.read().astype(int).sum(axis=2))
    dull, wet = frames
    assert dull.max() < 400 and wet.max() > 600
    assert ((wet - dull) > 150).mean() < 0.03


def test_parts_and_mesh_hide_each_other(surface: render.Surface) -> None:
    """Depth decides, whichever is drawn first."""
    renderer = render.Renderer(surface)
    wall = lent(renderer, square(z=10.0))
    ball = Ball()
    surface.begin()
    renderer.draw_background(PLAIN)
    renderer.draw_mesh(wall, facing(), PLAIN)
    renderer.draw_parts([ball], STILL, facing(), PLAIN)
    surface.end()
    frame = surface.read().astype(np.int32)
    assert at(frame, 0.0, 0.0)[2] > at(frame, 0.0, 0.0)[0]  # the ball's front comes through
    assert at(frame, 19.0, 0.0)[0] > at(frame, 19.0, 0.0)[2]  # its rim is behind the wall


def test_parts_have_one_side(surface: render.Surface) -> None:
    """Of a part, only the side from which its triangles run counter-clockwise is drawn."""
    ball = Ball()
    behind = ball.vertices[ball.faces].mean(axis=1)[:, 2] < 0.0
    bowl = ball.shape.triangles[behind]
    renderer = render.Renderer(surface)
    shown = []
    for triangles, normals in ((bowl, ball.normals), (bowl[:, ::-1], -ball.normals)):
        part = Ball(shape=Shape(ball.vertices, normals, triangles))
        surface.begin()
        renderer.draw_background(PLAIN)
        renderer.draw_parts([part], STILL, facing(), PLAIN)
        surface.end()
        shown.append(at(surface.read().astype(np.int32), 0.0, 0.0))
    assert shown[0].min() >= 254
    assert 60 < shown[1][2] < 250 and shown[1][2] > 2 * shown[1][0]


def test_part_errors(surface: render.Surface) -> None:
    """Unknown bones and misshapen parts are refused by name."""
    renderer = render.Renderer(surface)
    with pytest.raises(ValueError, match="part 'ball' moves with bone 'tail'; transforms has only"):
        renderer.draw_parts([Ball(bone="tail")], STILL, facing(), PLAIN)
    shape = sphere(0)
    broken = Ball(shape=Shape(shape.positions, shape.normals[:4], shape.triangles))
    with pytest.raises(ValueError, match=r"part 'ball': vertices \(6, 3\), normals \(4, 3\)"):
        renderer.draw_parts([broken], STILL, facing(), PLAIN)


def test_lines_before_and_behind(surface: render.Surface) -> None:
    """A line in front has its full colour, one behind shines through, and 0 hides it."""
    renderer = render.Renderer(surface)
    wall = lent(renderer, square())
    over = np.array([(-40, 20, 5), (0, 20, 5), (40, 20, 5)], np.float64)
    under = over - (0, 40, 10)
    frames = []
    for hidden_opacity in (0.5, 0.0):
        surface.begin()
        renderer.draw_background(PLAIN)
        renderer.draw_mesh(wall, facing(), PLAIN)
        renderer.draw_lines(
            [over, under],
            np.array([(0, 0.8, 0), (0, 0, 0.9)]),
            facing(),
            width=4.0,
            hidden_opacity=hidden_opacity,
        )
        surface.end()
        frames.append(surface.read().astype(np.int32))
    skin = at(frames[0], 0.0, 0.0)
    for frame in frames:
        assert at(frame, 10.0, 20.4) == pytest.approx((0, 204, 0), abs=3)
    assert at(frames[0], 10.0, -20.0) == pytest.approx(skin * 0.5 + np.array((0, 0, 115)), abs=6)
    assert at(frames[1], 10.0, -20.0) == pytest.approx(skin, abs=3)


def test_lines_are_not_joined(surface: render.Surface) -> None:
    """Nothing is drawn from the end of one line to the start of the next; empty lines are fine."""
    renderer = render.Renderer(surface)
    left = np.array([(-40.0, -10, 0), (-40, 10, 0)])
    right = np.array([(40.0, -10, 0), (40, 10, 0)])
    surface.begin()
    renderer.draw_background(PLAIN)
    renderer.draw_lines([], (1, 0, 0), facing())
    renderer.draw_lines([np.zeros((0, 3)), left, np.zeros((1, 3)), right], (1, 0, 0), facing())
    surface.end()
    columns = np.nonzero(drawn(surface.read().astype(np.int32)).any(axis=0))[0]
    assert len(columns) > 2 and not ((columns > 20) & (columns < 76)).any()


def test_line_colours_must_fit(surface: render.Surface) -> None:
    """One colour, or one per line."""
    line = np.zeros((3, 3))
    with pytest.raises(ValueError, match=r"colour has shape \(2, 3\); it must be \(3,\), or one"):
        render.Renderer(surface).draw_lines([line], np.zeros((2, 3)), facing())


@pytest.mark.parametrize("kind", [render.ColourBy.AMOUNT, render.ColourBy.SIGNED])
def test_amounts_colour_triangles(surface: render.Surface, kind: render.ColourBy) -> None:
    """None leaves the skin as it is; the most is another colour; the least only with a sign."""
    nothing = 128 if kind is render.ColourBy.SIGNED else 0
    style, shape = replace(PLAIN, colour_by=kind), sphere()
    plain = picture(surface, shape)
    pictures = {
        value: picture(surface, shape, style, values=np.full(len(shape.triangles), value, np.uint8))
        for value in (0, nothing, 255)
    }
    difference = {value: np.abs(picture - plain).max() for value, picture in pictures.items()}
    assert difference[nothing] < 8
    assert difference[255] > 60
    assert (difference[0] > 60) == (kind is render.ColourBy.SIGNED)
