"""Hair of persons: it grows on the scalp, stands off the head, and leaves the face free."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree, geometric_slerp

from risorius.app.anatomy import AnatomyView, DrawnAnatomy
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.passes.passes import Passes
from risorius.app.scenes import FaceScene
from risorius.assets import Segment, load
from risorius.assets.data_files import read_arrays
from risorius.assets.identities import (
    HAIR_NAME,
    Features,
    coloured,
    make_person,
    person_called,
    sample_identity,
)
from risorius.assets.identities.hair import HAIR_CUTS, Fall
from risorius.assets.identities.hairline import Hairline
from risorius.assets.identities.long_hair import _between_ways, _skin_reach
from risorius.geometry.closest import closest_points
from risorius.geometry.directions import unit_vectors
from risorius.render import Style
from tests.assets.checks import check_part, part_of
from tests.heads import person_of


@cache
def haired(cut, *, receded=0.0, length=1.0):
    """A person with a haircut."""
    identity = replace(sample_identity(0), cut=cut, hair=length)
    return coloured(
        make_person(identity), angle=30.0, features=Features(hairline=Hairline(front=receded))
    )


def hair_of(person, name=HAIR_NAME):
    """A part of the person's hair, by default the hair on the scalp."""
    return part_of(person, name)


@pytest.mark.parametrize("cut", HAIR_CUTS)
def test_hair_is_a_sound_part(cut):
    """Arrays of hair fit together, and triangles are visible from the side of their normals."""
    for part in [
        each for each in haired(cut).parts if each.name in (HAIR_NAME, HAIR_NAME + "_tied")
    ]:
        check_part(part, least_agreeing=0.9)  # at the hairline the lower side of hair turns over
        assert part.bone == "cranium"
        assert part.striation.shape == (len(part.vertices), 7)
        assert np.isfinite(part.striation).all()


@pytest.mark.parametrize("cut", HAIR_CUTS)
def test_hair_stands_off_the_scalp_and_leaves_the_face_free(cut):
    """Dense hair is above the skin, and no hair hangs before brows, eyes, nose and mouth."""
    person = haired(cut)
    part = hair_of(person)
    way = part.striation[:, 2:5]
    dense = part.striation[:, 5] > 0.8
    tips = part.vertices + 0.4 * way
    roots = part.vertices - 0.6 * way
    over = [((each - roots) * part.normals).sum(axis=1)[dense] for each in (part.vertices, tips)]
    assert over[0].min() >= 0.0
    assert np.median(over[1]) > 2.0
    if not isinstance(HAIR_CUTS[cut], Fall):  # hangs beside the head
        nearest = cKDTree(person.vertices).query(roots)[1]
        heights = ((roots - person.vertices[nearest]) * part.normals).sum(axis=1)
        assert np.quantile(np.abs(heights[dense]), 0.95) < 4.0
    face = person.vertices[person.landmarks[17:68]]
    low = face.min(axis=0)
    high = face.max(axis=0)
    is_before = ((tips > low) & (tips < high + np.array([0.0, 2.0, 60.0]))).all(axis=1)
    assert not (is_before & (part.striation[:, 5] > 0.0)).any()


def test_hair_is_as_long_and_begins_where_it_is_set():
    """Longer hair reaches farther down, and receded hair begins farther back."""
    usual, longer, receded = (
        hair_of(haired("brushed", length=length, receded=by))
        for length, by in ((1.0, 0.0), (1.3, 0.0), (1.0, 20.0))
    )
    assert longer.vertices[:, 1].max() > usual.vertices[:, 1].max() + 0.5
    dense = [part.striation[:, 5] > 0.3 for part in (usual, receded)]
    assert receded.vertices[dense[1], 2].max() < usual.vertices[dense[0], 2].max() - 5.0


def test_sideburns_reach_the_ears(head):
    """Hair stands as densely beside the root of an ear as in the sideburn; 0.35 of 0.6 once."""
    scalp = read_arrays(head.file_beside("_tints.npz"))["scalp"]
    for side in (scalp, scalp[:, ::-1]):
        assert side[610:634, 1037].min() > 50


def test_the_middle_of_the_nape_has_as_much_hair_as_its_sides(head):
    """Two tenths of a millimetre beside the midline the map of hair differs by at most 1.5 mm.

    Texels of the nape are long and aslant, so a coarse map had a pale line there.
    """
    scalp = 0.3 * read_arrays(head.file_beside("_tints.npz"))["scalp"]
    size = len(scalp)
    upper = 74  # vertices of the midline
    lower = 73
    is_nape = np.isin(head.faces, (upper, lower)).sum(axis=1) == 2
    for face in head.faces[is_nape]:
        beside = next(vertex for vertex in face if vertex not in (upper, lower))
        share = 0.2 / np.linalg.norm(head.vertices[beside, 0])
        for down in (0.1, 0.3, 0.5):
            middle = (1.0 - down) * head.uv[upper] + down * head.uv[lower]
            places = np.array([middle, middle + share * (head.uv[beside] - middle)])
            at = [(1.0 - places[:, 1]) * size - 0.5, places[:, 0] * size - 0.5]
            behind = map_coordinates(scalp, at, order=1)
            assert abs(behind[1] - behind[0]) < 1.5


def test_bobs_are_cut_off_without_a_veil():
    """Person 28's hair behind the head ends within a centimetre, lock by lock.

    Down to there, the density is above 0.5, at which half of the locks end.
    """
    hair = part_of(person_called(28), HAIR_NAME)
    dense = hair.striation[:, 5].reshape(51, -1)[15:36]
    tips = hair.vertices.reshape(51, -1, 3)[15:36, -2:]
    assert np.linalg.norm(np.diff(tips, axis=1), axis=2).max() < 12.0
    assert (dense[:, -1] == 0.0).all()
    assert (dense[:, -2] > 0.5).all()
    assert (hair.striation[:, 6].reshape(51, -1)[15:36, -2:] == -1.0).all()


def test_cropped_hair_has_no_ring_of_light_around_its_whorl():
    """Cropped hair is dull, so that its whorl has no bright ring; longer hair shines as before."""
    shines = {cut: hair_of(haired(cut)).shine for cut in ("cropped", "short", "brushed")}
    assert shines["cropped"] < 0.25 * shines["short"]
    assert shines["short"] == shines["brushed"] == 0.12


@pytest.mark.parametrize("cut", ["tailed", "knotted", "topknot"])
def test_layers_of_tied_hair_have_no_gap_at_their_seam(cut):
    """First and last strand have equal points, normals and layers; a gap would let light in."""
    tied = hair_of(haired(cut), HAIR_NAME + "_tied")
    point_count = 40
    for each in (tied.vertices, tied.normals, tied.striation[:, 2:5]):
        np.testing.assert_allclose(each[:point_count], each[-point_count:], atol=1e-6)


def test_a_tail_ends_in_a_point():
    """The end of a tail is thin, so that the hollow between its layers is not visible."""
    tied = hair_of(haired("tailed"), HAIR_NAME + "_tied").vertices.reshape(-1, 40, 3)
    assert np.ptp(tied[:, -1], axis=0).max() < 3.0  # [mm]


def test_a_ponytail_touches_no_skin_below():
    """A ponytail hangs behind the ears without touching neck and shoulders."""
    person = haired("tailed")
    tail = hair_of(person, HAIR_NAME + "_tied").vertices
    ear = person.anatomy["tragion_left"]
    low = tail[tail[:, 1] < person.vertices[ear, 1] - 50.0]
    assert tail[:, 2].max() < person.vertices[ear, 2] - 50.0
    assert len(low)
    assert cKDTree(person.vertices).query(low)[0].min() > 8.0


def test_hair_keeps_its_colour_in_other_tones_of_skin():
    """Another skin tone leaves the scalp below hair unchanged; newly made hair follows the tone."""
    ada = person_called("ada")
    assert ada.in_tone is not None
    assert person_of(0).in_tone is None
    change = np.abs(ada.in_tone(-40.0).astype(float) - ada.albedo).mean(axis=2)
    scale = len(change) // len(ada.segments)
    segments = np.kron(ada.segments, np.ones((scale, scale), np.uint8))
    assert change[segments == Segment.NOSE].mean() > 30.0
    assert np.median(change[segments == Segment.HAIR]) < 10.0
    mine = hair_of(ada)
    darker = hair_of(coloured(ada, angle=-50.0))
    assert darker.colours.mean() < 0.8 * mine.colours.mean()


def is_layered(part):
    """Whether a part is drawn as layers of hair."""
    return part.striation is not None and part.striation.shape[1] == 7


def label_of(person):
    """A picture and its segmentation."""
    options = CaptureOptions(size=(200, 200), passes=("segmentation",))
    with Capture(FaceScene(person), options) as capture:
        image = capture.draw_image()
        passes = Passes(capture.pipeline, capture.viewports[-1].drawn)
        classes = passes.draw(capture.camera, capture.options.style, ("segmentation",))
        return image, classes["segmentation"]


def test_sparse_hair_has_the_class_behind_it():
    """A pixel has the class of hair only where at least half of the strands are.

    Elsewhere, as at sparse tips, it has the class behind the hair.
    """
    long = haired("parted")
    few = np.float32([1.0, 1.0, 1.0, 1.0, 1.0, 0.2, 1.0])
    parts = [
        replace(each, striation=each.striation * few) if is_layered(each) else each
        for each in long.parts
    ]
    found = [label_of(each)[1] == Segment.HAIR for each in (long, replace(long, parts=parts))]
    assert 0 < found[1].sum() < 0.6 * found[0].sum()


def test_hair_is_framed_and_labelled():
    """Hair is inside the frame, has its class, and is hidden over muscles and on clay."""
    scene = FaceScene(person_called("ada"))
    assert scene.skin.fade is None  # no fade, because a shirt covers the end of the neck
    assert scene.framing.framed[:, 1].max() >= hair_of(person_called("ada")).vertices[:, 1].max()
    image, classes = label_of(haired("short"))
    is_hair = classes == Segment.HAIR
    assert is_hair.mean() > 0.043
    assert (classes[0] == Segment.BACKGROUND).all()
    assert image[is_hair].mean() < 0.4 * image[classes == Segment.SKIN].mean()
    assert (label_of(haired("cropped"))[1] == Segment.HAIR).sum() < is_hair.sum()
    anatomy = DrawnAnatomy(scene)
    opened = AnatomyView(("muscles",))
    clay = AnatomyView()
    for seen in (anatomy.dissect(opened), anatomy.dissect(clay, has_hair=False)):
        assert seen.parts
        assert not [each for each in seen.parts if each.part.name.startswith(HAIR_NAME)]


def test_lobes_of_ears_stay_under_hair_that_falls():
    """Earlobes do not come through a short bob with tips that curve to the face."""
    person = person_called(4)
    hair = hair_of(person)
    rings = load("head").rings
    lobes = np.unique(np.concatenate([rings["ear_1_left"], rings["ear_1_right"]]))
    lobes = lobes[person.vertices[lobes, 1] < person.vertices[lobes, 1].min() + 12.0]
    points = person.vertices[lobes]
    nearest = cKDTree(hair.vertices).query(points)[1]
    off = ((points - hair.vertices[nearest]) * hair.normals[nearest]).sum(axis=1)
    assert off.max() < -2.0


def gaps(person, rows, camera="60,5"):
    """The number of background pixels between the left and right outline in some rows."""
    options = CaptureOptions((700, 700), camera=camera, style=Style(background=None))
    with Capture(FaceScene(person), options) as capture:
        is_seen = capture.draw_image()[rows, :, 3] >= 128
    is_inside = np.logical_or.accumulate(is_seen, axis=1)
    is_inside &= np.logical_or.accumulate(is_seen[:, ::-1], axis=1)[:, ::-1]
    return int((is_inside & ~is_seen).sum())


def test_no_slit_is_between_hair_and_the_refined_nape():
    """From behind the ear no gap shows between hair and nape.

    There, hollow skin lies deeper than its coarse triangles.
    """
    assert gaps(load("head"), slice(370, 450)) < 30


def test_no_slit_is_below_the_hem_of_a_bald_crown():
    """No gap shows below the hem of hair around a bald crown, at the horizon of the skin."""
    features = Features(hairline=Hairline(front=6.0, temples=12.0, crown=0.5))
    person = make_person(replace(sample_identity(0), cut="swept", hair=1.0))
    assert gaps(coloured(person, angle=30.0, features=features), slice(30, 70)) < 40


def test_no_slit_is_below_the_outline_of_hair_from_above():
    """From above, no gap shows below the outline of swept-back hair."""
    assert gaps(haired("knotted"), slice(0, 330), camera="0,65") < 40


def test_hair_behind_ears_lies_above_the_skin():
    """Strands combed back behind an ear stay above the skin; skin over them was a grey patch."""
    person = person_called(2)
    hair = hair_of(person)
    skin = closest_points(hair.vertices, person.vertices, person.faces)
    off = hair.vertices - skin.interpolate(person.vertices)
    is_dense = hair.striation[:, 5] > 0.5
    assert (off * hair.normals).sum(axis=1)[is_dense].min() > -0.5  # [mm]; it was -1.5


@pytest.mark.parametrize("number", [92000113, 92000121])
def test_the_inner_side_of_tied_hair_stands_off_the_skin(number):
    """No inner side lies on the skin: in the groove before an ear it showed as black dashes."""
    person = person_called(number)
    inside = part_of(person, "hair_inside")
    places = inside.vertices.astype(np.float64)
    nearest = closest_points(places, person.vertices, person.faces)
    away = np.linalg.norm(places - nearest.interpolate(person.vertices), axis=1)
    assert np.percentile(away, 1.0) > 1.0


def test_strands_turn_along_great_circles(generator):
    """Strands turn along great circles, as scipy interpolates each of them."""
    start, end = unit_vectors(generator.normal(size=(2, 8, 3)).reshape(-1, 3)).reshape(2, 8, 3)
    shares = np.linspace(0.0, 1.0, 5)
    wanted = [geometric_slerp(*pair, shares) for pair in zip(start, end, strict=True)]
    assert _between_ways(start, end, shares) == pytest.approx(np.array(wanted), abs=1e-12)


def test_hair_reaches_over_the_farthest_skin_near_by(generator):
    """The reach of hair is a soft maximum of the skin's distance near a direction."""
    solid = 90.0 * unit_vectors(generator.normal(size=(300, 3)))
    solid *= generator.uniform(0.9, 1.1, (300, 1))
    ways = unit_vectors(generator.normal(size=(12, 3))).reshape(4, 3, 3)
    far = np.linalg.norm(solid, axis=1)
    weights = np.exp(120.0 * (ways @ (solid / far[:, None]).T - 1.0))
    wanted = ((weights * far**24).sum(axis=-1) / weights.sum(axis=-1)) ** (1.0 / 24.0)
    assert _skin_reach(ways, solid) == pytest.approx(wanted, rel=1e-12)


def test_strands_stand_up_at_a_whorl_and_lie_around_it():
    """Strands stand up at a whorl, and lie around it.

    Otherwise they would turn there from one direction to all others, and their shine would be a
    ring.
    """
    hair = hair_of(haired("short"))
    way = hair.striation[:, 2:5]
    long = np.maximum(np.linalg.norm(way, axis=1), 1e-6)
    lying = 1.0 - ((way * hair.normals).sum(axis=1) / long) ** 2
    along = hair.striation[:, 1]  # [mm] from the whorl
    assert lying[along < 4.0].max() < 0.1
    assert lying[(along > 30.0) & (along < 50.0)].min() > 0.4


@pytest.mark.parametrize("number", [8, 91000039])
def test_triangles_of_the_nape_cut_no_corners_out_of_tied_hair(number):
    """In the hollow nape the layers lie over the coarse triangles of skin; once below."""
    person = person_called(number)
    hair = part_of(person, HAIR_NAME)
    is_nape = (np.abs(hair.vertices[:, 0]) < 15.0) & (hair.vertices[:, 2] < -45.0)
    is_nape &= (hair.striation[:, 5] > 0.2) & (hair.vertices[:, 1] < -65.0)
    layers = hair.vertices[is_nape].astype(np.float64)
    assert len(layers) > 2
    nearest = closest_points(layers, person.vertices, person.faces)
    off = layers - nearest.interpolate(person.vertices)
    assert (off * hair.normals[is_nape]).sum(axis=1).min() > 0.3
