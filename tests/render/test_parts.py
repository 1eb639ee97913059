"""Rigid parts: their places by bones, their shine, and their visibility."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from pytest import approx

from risorius import render

from .scenes import (
    PLAIN_STYLE,
    STILL_TRANSFORMS,
    Ball,
    Shape,
    at,
    draw,
    drawn,
    facing,
    lent,
    square,
    still,
)


def reshaped(ball, **changes):
    """A ball with some arrays replaced."""
    names = ("vertices", "normals", "faces", "colours", "striation")
    part = SimpleNamespace(**vars(ball), **{name: getattr(ball, name) for name in names})
    vars(part).update({name: array.astype(np.float32) for name, array in changes.items()})
    return part


def test_parts_move_with_their_bones(renderer):
    """A part is drawn at the place given by its bone's matrix, for column vectors."""
    ball = Ball(bone="eye_left")
    places = []
    for x in (-25.0, 25.0):
        moved = np.eye(4)
        moved[:3, 3] = (x, 0.0, 0.0)
        frame = draw(renderer, parts=[render.PlacedPart.on_bone(ball, {"eye_left": moved})])
        assert at(frame, x, 0.0)[2] > at(frame, x, 0.0)[0] + 30
        places.append(np.nonzero(drawn(frame))[1].mean())
    assert places[0] == approx(47.5 - 21.5, abs=1.5)
    assert places[1] == approx(47.5 + 21.5, abs=1.5)


def test_a_part_that_changes_its_shape_is_drawn_anew(renderer):
    """New arrays of the same part are uploaded, even after other parts were drawn."""
    pixels = []
    ball = Ball()
    part = reshaped(ball)
    for scale in (1.0, 0.5):
        part.vertices = (scale * ball.vertices).astype(np.float32)
        pixels.append(drawn(draw(renderer, parts=still(part))).sum())
    assert 0.2 * pixels[0] < pixels[1] < 0.3 * pixels[0]


def test_wet_parts_have_a_crisp_highlight(renderer):
    """Shine makes a few pixels nearly white, and changes only these and the outline."""
    frames = []
    for shine in (0.0, 1.0):
        style = replace(PLAIN_STYLE, background=render.DARK)
        ball = Ball(shine=shine, colour=(0.1, 0.1, 0.1))
        image = draw(renderer, style=style, parts=still(ball), camera=facing(25.0))
        frames.append(image.sum(axis=2))
    dull, wet = frames
    assert dull.max() < 400
    assert wet.max() > 600
    away = np.hypot(*(np.indices(wet.shape) - 47.5))  # [pixels]; the outline is at 35
    assert ((wet - dull) > 150)[away < 30.0].mean() < 0.015


def test_parts_and_mesh_hide_each_other(renderer):
    """Of a part and the mesh, the nearer surface is visible."""
    wall = lent(renderer, square(z=10.0))
    frame = draw(renderer, wall, parts=still(Ball()))
    assert at(frame, 0.0, 0.0)[2] > at(frame, 0.0, 0.0)[0]  # the ball's front is before the wall
    assert at(frame, 19.0, 0.0)[0] > at(frame, 19.0, 0.0)[2]  # the ball's rim is behind the wall


def test_parts_have_one_side(renderer):
    """Only the side whose triangles run counter-clockwise is drawn."""
    ball = Ball()
    behind = ball.vertices[ball.faces].mean(axis=1)[:, 2] < 0.0
    bowl = ball.shape.triangles[behind]
    shown = []
    for triangles, normals in ((bowl, ball.normals), (bowl[:, ::-1], -ball.normals)):
        part = Ball(shape=Shape(ball.vertices, normals, triangles))
        shown.append(at(draw(renderer, parts=still(part)), 0.0, 0.0))
    assert shown[0].min() >= 254
    assert 60 < shown[1][2] < 250
    assert shown[1][2] > 2 * shown[1][0]


def test_part_errors():
    """Unknown bones are refused by name."""
    with pytest.raises(ValueError, match="part 'ball' moves with bone 'tail'; transforms has only"):
        still(Ball(bone="tail"))


@pytest.mark.parametrize("samples", [0, 4])
def test_hairs_thinner_than_a_pixel_fade_and_stay_whole(samples):
    """A hair thinner than a pixel covers as much light at any resolution, evenly along it."""
    taken = []
    for scale in (1, 2, 4):
        with render.open_offscreen((60 * scale, 60 * scale), samples=samples) as surface:
            renderer = render.Renderer(surface)
            ends = np.array([[-20.0, -7.0, 0.0], [20.0, 7.0, 0.0]])
            side = 0.2 * np.array([[-0.33, 0.94, 0.0], [0.165, -0.47, 0.82], [0.165, -0.47, -0.82]])
            normals = np.vstack([side, side]).astype(np.float32) / 0.2
            faces = []
            for a, b in ((0, 1), (1, 2), (2, 0)):  # corners of one end; the other end's follow
                faces += [[a, 3 + b, b], [a, 3 + a, 3 + b]]
            hair = SimpleNamespace(
                name="hair", bone="cranium", shine=0.0, normals=normals,
                is_enclosed=True, strand_radius=0.2, striation=None,
                vertices=(np.repeat(ends, 3, axis=0) + np.vstack([side, side])).astype(np.float32),
                colours=np.full((6, 3), 0.05, np.float32),
                faces=np.array(faces, np.int32),
            )  # fmt: skip
            darker = 255.0 - draw(renderer, parts=still(hair)).mean(axis=2)
        columns = darker.sum(axis=0)
        middle = columns[int(0.35 * len(columns)) : int(0.65 * len(columns))]
        assert middle.min() > 0.9 * middle.mean()
        assert middle.std() < 0.05 * middle.mean()
        taken.append(darker.sum() / scale**2)
    assert max(taken) < 1.1 * min(taken)


def test_hair_is_dense_up_to_its_outline(renderer):
    """Hair covers the skin up to its outline, which has no veil; bare places stay bare."""
    ball = Ball(colour=(0.1, 0.1, 0.1))
    covers = []
    for dense in (1.0, 0.0):
        out = ball.normals
        striation = np.column_stack([3.0 * ball.vertices[:, :2], 10.0 * out, 0.0 * out[:, :2]])
        striation[:, 5] = dense
        hair = reshaped(ball, vertices=ball.vertices + 6.0 * out, striation=striation)
        row = 255 - draw(renderer, parts=still(hair))[48].mean(axis=1)
        covers.append(row[48:])
    assert not covers[1].any()
    pixels = covers[0]  # 0.86 mm each; roots are 20 mm from the middle
    assert pixels[:20].min() > 150.0
    assert not pixels[27:].any()
    assert ((pixels > 5.0) & (pixels < 200.0)).sum() <= 2


def test_outlines_of_hair_fray_and_leave_no_dotted_ring(renderer):
    """Where hair frays, its cover falls toward the outline, and no dotted ring remains there."""
    ball = Ball(colour=(0.1, 0.1, 0.1))
    rows, columns = np.mgrid[:96, :96] - 47.5
    radius = np.hypot(rows, columns).astype(int)
    rings = []
    for fray in (0.0, 1.0):
        fixed = np.tile([1.0, fray], (len(ball.normals), 1))
        columns = 0.3 * ball.vertices[:, :2], 10.0 * ball.normals, fixed
        hair = reshaped(
            ball,
            vertices=ball.vertices + 6.0 * ball.normals,
            striation=np.column_stack(columns),
        )
        dark = 255.0 - draw(renderer, parts=still(hair)).mean(axis=2)
        rings.append([dark[radius == k].mean() for k in range(40)])
    smooth, frayed = np.array(rings)
    edge = int(np.argmax(smooth < 100.0))  # pixels of 0.86 mm
    assert np.abs(frayed - smooth)[: edge - 4].max() < 8.0
    assert (frayed <= smooth + 8.0).all()
    assert 0.3 < (smooth - frayed).sum() / smooth[0] < 1.5  # pixels


def test_the_hem_of_loose_hair_does_not_hide_hair_behind_it(renderer):
    """Hair behind a thin hem is visible through it: bobs had a bright line along the hem.

    Thin pixels of the hem hid all hair that was drawn later.
    """
    darks = []
    for fray in (0.0, -1.0):
        parts = []
        for forward in (12.0, 0.0):  # both have the same outline; the first ends at half its height
            ball = Ball(colour=(0.1, 0.1, 0.1))
            height = ball.vertices[:, 1:2]
            dense = np.clip(1.0 + 0.1 * height, 0.0, 2.0) if forward else 2.0 + 0.0 * height
            columns = ball.vertices[:, :2], 4.0 * ball.normals, dense, fray + 0.0 * dense
            parts.append(
                reshaped(
                    ball,
                    vertices=ball.vertices + np.array([0.0, 0.0, forward]),
                    striation=np.hstack(columns),
                )
            )
        image = draw(renderer, parts=still(*parts)).mean(axis=2)
        darks.append(image[42:62, 44:53].max())
    veiled, loose = darks
    assert loose < 90.0 < veiled


def test_hair_hides_the_skin_behind_it(renderer):
    """Hair hides the outline of skin behind it."""
    wall = lent(renderer, square(z=-5.0))
    ball = Ball(colour=(0.1, 0.1, 0.1))
    fixed = np.tile([1.0, 0.0], (len(ball.vertices), 1))
    striation = np.column_stack([ball.vertices[:, :2], 6.0 * ball.normals, fixed])
    hair = reshaped(ball, striation=striation)
    frame = draw(renderer, wall, parts=still(hair))
    assert at(frame, 0.0, 0.0).max() < 100 < at(frame, 30.0, 30.0).max()


def test_hair_shines_where_it_lies_and_not_by_how_far_it_stands_off(renderer):
    """The highlight depends on the direction of strands, not on how steeply they stand.

    Otherwise a dark patch with a ring would appear where strands begin.
    """
    ball = Ball(colour=(0.02, 0.02, 0.02), shine=0.4)
    out = ball.normals
    down = np.array([0.0, -1.0, 0.0]) + out[:, 1:2] * out
    rows = []
    most = []
    for lean in (0.2, 0.6, 9.0):
        way = 2.0 * (lean * out + down) / max(lean, 1.0)
        columns = ball.vertices[:, :1], 0.0 * out[:, :1], way
        striation = np.column_stack([*columns, np.full(len(out), 2.0), np.zeros(len(out))])
        image = draw(renderer, parts=still(reshaped(ball, striation=striation)))
        light = image[34:60, 38:58].mean(axis=(1, 2))
        rows.append(int(np.argmax(light)))
        most.append(light.max())
    assert abs(rows[1] - rows[0]) < 3
    assert most[2] < 0.5 * most[0]  # of strands that stand up only tips are visible


def test_a_hem_of_hair_throws_no_shadow(renderer):
    """Where no strand is visible, hair throws no shadow; dense hair does."""
    lit = []
    for dense in (0.0, 2.0):
        wall = lent(renderer, square(z=-25.0))
        ball = Ball(colour=(0.1, 0.1, 0.1))
        columns = [
            ball.vertices[:, :2],
            4.0 * ball.normals,
            np.tile([dense, 0.0], (len(ball.vertices), 1)),
        ]
        hair = reshaped(ball, striation=np.hstack(columns))
        placed = [render.PlacedPart.on_bone(hair, STILL_TRANSFORMS, throws_shadow=True)]
        style = replace(PLAIN_STYLE, shadows=True)
        lit.append(draw(renderer, wall, style=style, parts=placed).sum(axis=2))
    shaded = (lit[0] - lit[1])[60:, 56:]  # below and right: the key is above at the left
    assert shaded.max() > 100
    wall_alone = draw(
        renderer, lent(renderer, square(z=-25.0)), style=replace(PLAIN_STYLE, shadows=True)
    )
    assert np.abs(lit[0] - wall_alone.sum(axis=2)).max() < 12
