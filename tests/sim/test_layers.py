"""Layers: tables of controls above the muscles. They add up, have sides, and report errors."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.sim.controls import Control, Controls
from risorius.sim.layers import BOTH_SIDES, LEAST_WHOLE, read_layers
from tests.sim.poses import FRAME_TIME, inverted_triangles, lip_gap, settled_displacement

LOWEST_CONTROLS = ("puller_left", "puller_right", "middle", "slide")
ACTION_UNITS = (
    *(f"AU{n}" for n in (1, 2, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20)),
    *(f"AU{n}" for n in (22, 23, 24, 25, 26, 27, 28, 29, 30, 34, 43, 45, 46, 61, 62, 63, 64)),
)
ONE_SIDED = ("AU1", "AU2", "AU4", "AU6", "AU7", "AU9", "AU10", "AU12", "AU14", "AU15", "AU20")
EXPRESSIONS = (
    "joy", "sadness", "surprise", "anger", "disgust", "fear", "contempt", "wink", "kiss", "yawn",
    "mouth_open", "blink",
)  # fmt: skip
HEAD_UNITS = ("AU51", "AU52", "AU53", "AU54", "AU55", "AU56")
ARKIT_COUNTS = {  # numbers of ARKit's shapes for each part of the face
    "eye": 14, "jaw": 4, "mouth": 23, "brow": 5, "cheek": 3, "nose": 2, "tongue": 1,
}  # fmt: skip
TITLES = ("Action units", "Expressions", "Visemes", "ARKit shapes")
VISEMES = "sil PP FF TH DD kk CH SS nn RR aa E ih oh ou".split()


def layer(title, **rows):
    """A table in the form in which assets reads it."""
    return SimpleNamespace(title=title, source=f"{title}.toml", rows=rows)


def controls(*layers):
    """Four lowest controls, one with two directions, below some layers."""
    lowest = tuple(
        Control(name, "Lowest", -1.0 if name == "slide" else 0.0) for name in LOWEST_CONTROLS
    )
    return Controls(lowest, read_layers(layers, LOWEST_CONTROLS))


UNITS_LAYER = layer(
    "Units",
    A={"action": "pulls", "pair": True, "puller": 0.8, "middle": 0.6},
    B_left={"slide": 1.0},
    B_right={"slide": -1.0},
)
FACES_LAYER = layer("Faces", both={"A": 0.5, "slide": 0.25}, lopsided={"A_left": 1.5})


def sums_of(*numbers):
    """Sums of the lowest controls, in order."""
    return dict(zip(LOWEST_CONTROLS, numbers, strict=True))


def wanted(subject, **values):
    """The expected sums: these values, and 0 for all other lowest controls."""
    subject.pose(values)
    return subject.sums


def test_rows_add_to_the_layers_below():
    """A row scales its entries through every layer, down to the muscles."""
    subject = controls(UNITS_LAYER, FACES_LAYER)
    assert wanted(subject, both=1.0) == approx(sums_of(0.4, 0.4, 0.3, 0.25))
    assert wanted(subject, both=0.5)["puller_left"] == approx(0.2)
    assert wanted(subject, puller=0.7) == sums_of(0.7, 0.7, 0.0, 0.0)


def test_sides_of_a_pair_add_up_to_the_whole():
    """A side activates its own muscles, and half of a muscle in the middle."""
    subject = controls(UNITS_LAYER)
    left = wanted(subject, A_left=1.0)
    right = wanted(subject, A_right=1.0)
    assert left == approx(sums_of(0.8, 0.0, 0.3, 0.0))
    whole = {name: left[name] + right[name] for name in LOWEST_CONTROLS}
    assert wanted(subject, A=1.0) == approx(whole)


def test_sides_may_be_spelled_as_arkit_does():
    """Sides named as in ARKit make two controls of one row, and none for both."""
    subject = controls(layer("Shapes", smile={"pair": "Left Right", "puller": 0.5, "middle": 0.2}))
    assert subject.groups["Shapes"] == ("smileLeft", "smileRight")
    assert "smile" not in subject.names
    assert wanted(subject, smileLeft=1.0) == approx(sums_of(0.5, 0.0, 0.1, 0.0))


SHAPES_LAYER = layer(
    "Shapes", whole={"slide": 1.0}, part={"share_of": "whole", "middle": 0.8, "puller": 0.5}
)


@given(part=st.floats(0.0, 1.0), whole=st.floats(0.0, 1.0))
def test_a_fraction_counts_as_part_of_the_whole(part, whole):
    """A share is its part divided by the whole, at most 1, also when the whole is near 0.

    It never jumps.
    """
    subject = controls(SHAPES_LAYER)
    share = wanted(subject, part=part, whole=whole)["middle"] / 0.8
    assert 0.0 <= share <= 1.0
    if whole > LEAST_WHOLE:
        assert share == approx(min(part / whole, 1.0))
    assert share <= whole / LEAST_WHOLE + 1e-12
    near = wanted(subject, part=part, whole=min(whole + 1e-4, 1.0))["middle"] / 0.8
    assert abs(near - share) < 2e-4 / LEAST_WHOLE


def test_a_fraction_follows_the_whole_that_is_set_later():
    """A share follows its whole in any order of setting, and everything it moves follows."""
    subject = controls(SHAPES_LAYER)
    subject.set_all({"part": 0.3})
    assert not subject.wanted.any()
    subject.set_all({"whole": 0.6})
    assert subject.wanted.tolist() == approx([0.25, 0.25, 0.4, 0.6])
    assert subject.values["part"] == 0.3


def test_floors_do_not_add_up():
    """Of several floors the greatest holds, through every layer, unless the sum exceeds it."""
    units = layer(
        "Units",
        A={"puller": 0.5, "at_least": {"slide": 0.4}},
        B={"pair": True, "at_least": {"slide": 0.2, "puller": 0.3}},
    )
    subject = controls(units, layer("Faces", both={"A": 0.5, "B": 1.0, "slide": 0.1}))
    assert wanted(subject, A=1.0)["slide"] == 0.4
    assert wanted(subject, A=1.0, slide=0.3)["slide"] == 0.4
    assert wanted(subject, A=1.0, slide=0.5)["slide"] == 0.5
    assert wanted(subject, A=0.5, B=1.0)["slide"] == approx(0.2)
    assert wanted(subject, both=1.0)["slide"] == approx(0.2)
    assert wanted(subject, both=1.0, slide=0.3)["slide"] == approx(0.4)
    assert wanted(subject, slide=-0.5)["slide"] == -0.5
    left = wanted(subject, B_left=1.0)
    assert left == sums_of(0.3, 0.0, 0.0, 0.2)
    assert wanted(subject, B_left=1.0, B_right=1.0) == wanted(subject, B=1.0)


def test_sums_are_cut_off_once_and_in_any_order():
    """A control's own value and its contributions are summed in any order, and clipped once.

    Opposite contributions cancel.
    """
    subject = controls(UNITS_LAYER, FACES_LAYER)
    other = controls(UNITS_LAYER, FACES_LAYER)
    values = {"puller_left": 0.5, "A": 0.9, "both": 1.0, "B_left": 1.0, "B_right": 0.4}
    for name, value in values.items():
        subject.set_all({name: value})
    for name in reversed(values):
        other.set_all({name: values[name]})
    assert subject.wanted.tolist() == other.wanted.tolist()
    sums = dict(zip(LOWEST_CONTROLS, subject.wanted.tolist(), strict=True))
    assert sums["puller_left"] == 1.0  # 0.5 + 0.72 + 0.4
    assert sums["slide"] == approx(1.0 - 0.4 + 0.25)
    assert subject.values["puller_left"] == 0.5, "a layer does not change values set below it"


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ({"X": {"pullr": 1.0}}, r"X.toml, 'X': no layer below .* 'pullr'; did you mean 'pull"),
        ({"X": {"middle": "1"}}, r"X.toml, 'X', 'middle': was '1', must be a number from -2"),
        ({"X": {"middle": True}}, r"'X', 'middle': was True, must be a number"),
        ({"X": {"middle": 2.5}}, r"'X', 'middle': was 2.5, .* from -2 to 2"),
        ({"X": 3}, r"'X': was 3, must be a table"),
        ({"X": {"pair": 1}}, r"'X', 'pair': was 1, must be true, false or \"Left Right\""),
        ({"XLeft": {"pair": "Left Right"}}, r"'XLeft': a pair adds the .*; omit 'Left'"),
        ({"X": {"mirror": 1}}, r"'X', 'mirror': was 1, must be a text"),
        ({"X": {"mirror": "Y", "pair": True}}, r"'X', 'mirror': was 'Y', must be another name"),
        ({"X": {"mirror": "middle"}}, r"'X': there is a control called 'middle' already"),
        ({"X": {"at_least": {"slide": -1}}}, r"'X', 'at_least', 'slide': was -1, .* 0 to 2"),
        ({"X": {"at_least": {"slid": 1.0}}}, r"'X': no layer below .* 'slid'; did you mean"),
        ({"X": {"share_of": 1.0}}, r"'X', 'share_of': was 1.0, must be a text"),
        ({"X": {"share_of": "midle"}}, r"'share_of': no row above .* 'midle'; did you mean 'mid"),
        ({"X": {"share_of": "X"}}, r"'share_of': no row above and no layer below .* called 'X'"),
        ({"X": {"pair": True, "puller_left": 1.0}}, r"in a pair omit the side of 'puller_left'"),
        ({"X_left": {"pair": True, "puller": 1.0}}, r"'X_left': a pair adds the sides"),
        ({"middle": {"slide": 1.0}}, r"'middle': there is a control called 'middle' already"),
        ({"A": {}, "B": {"A": 1.0}}, r"'B': no layer below has a control called 'A'"),
    ],
)
def test_a_wrong_row_is_named(rows, message):
    """The error has file, row and key, and the allowed values."""
    with pytest.raises(ValueError, match=message):
        controls(layer("X", **rows))


def test_a_row_cannot_use_a_fraction():
    """A row cannot use a control that is a fraction of another one.

    A fraction depends on set values, which a row in a higher layer does not have.
    """
    with pytest.raises(ValueError, match=r"'above', 'part': is a fraction of 'whole', and"):
        controls(SHAPES_LAYER, layer("Y", above={"part": 1.0}))


def test_the_shipped_tables_are_complete(controls, head):
    """Every action unit, expression and viseme is there, with a description of its effect."""
    names = controls.limits
    sided = {unit: (f"{unit}_left", f"{unit}_right") for unit in ("AU30", "AU46")}
    for unit in ACTION_UNITS:
        assert all(name in names for name in sided.get(unit, (unit,))), unit
    assert all(f"{unit}{side}" in names for unit in ONE_SIDED for side in ("_left", "_right"))
    assert set(EXPRESSIONS) <= set(controls.layers["Expressions"])
    assert controls.layers["Visemes"] == tuple(f"viseme_{sound}" for sound in VISEMES)
    shapes = controls.layers["ARKit shapes"]
    assert {
        part: sum(name.startswith(part) for name in shapes) for part in ARKIT_COUNTS
    } == ARKIT_COUNTS
    assert len(shapes) == 52
    assert tuple(controls.layers) == (BOTH_SIDES, *TITLES)
    for title in TITLES:
        assert all(controls.actions[name] for name in controls.layers[title])


def test_each_row_of_the_shipped_tables_does_something(controls):
    """At full value each row moves some muscle or bone, except the row of silence."""
    for title in TITLES:
        for name in controls.layers[title]:
            controls.pose({name: 1.0, **({"jawOpen": 0.5} if name == "mouthClose" else {})})
            assert any(controls.sums.values()) == (name != "viseme_sil"), name


def mirrored(sums):
    """The mirror image of the sums."""
    other = {"left": "right", "right": "left"}
    found = {}
    for name, value in sums.items():
        stem, mark, side = name.rpartition("_")
        is_turned = name.startswith("gaze_horizontal") or name == "jaw_sideways"
        found[stem + mark + other.get(side, side)] = -value if is_turned else value
    return found


def test_sides_of_arkit_shapes_ask_for_the_same(controls):
    """A left ARKit shape has the mirrored sums of its right partner."""

    def sums(name):
        controls.pose({name: 1.0})
        return controls.sums

    shapes = controls.layers["ARKit shapes"]
    twins = [name.removesuffix("Left") for name in shapes if name.endswith("Left")]
    assert len(twins) == 20
    for base in twins:
        assert sums(f"{base}Right") == approx(mirrored(sums(f"{base}Left"))), base


def test_expressions_have_sides(controls):
    """Both sides of an expression add up to the whole, and are mirror images of each other."""

    def sums(*names):
        controls.pose(dict.fromkeys(names, 0.5))
        return {name: value for name, value in controls.sums.items() if value}

    for name in ("joy", "sadness", "surprise", "anger", "disgust", "fear", "blink"):
        assert sums(f"{name}_left", f"{name}_right") == approx(sums(name)), name
        pulls = {key for key, value in sums(f"{name}_left").items() if value > 0.26}
        assert pulls and not any(key.endswith("_right") for key in pulls), name
    for name in ("wink", "contempt"):
        assert sums(f"{name}_right") == approx(mirrored(sums(name))), name


def test_the_jaw_of_a_funnel_counts_once(controls):
    """Funnelled lips open a shut jaw, and do not move an open one."""
    controls.pose({"AU22": 1.0, "mouthPucker": 0.5})
    assert controls.sums["jaw_open"] == approx(0.22)
    controls.pose({"AU22": 1.0, "jawOpen": 0.5})
    assert controls.sums["jaw_open"] == 0.5


def test_mouth_close_shuts_an_open_jaw(simulation, head):
    """Equal mouthClose and jawOpen close the lips at any opening.

    Half of mouthClose half closes them.
    """
    for opening in (0.2, 0.6):
        gaps = []
        for share in (0.0, 0.5, 1.0):
            settled_displacement(simulation, {"jawOpen": opening, "mouthClose": share * opening})
            gaps.append(lip_gap(simulation, head))
        assert gaps[0] > 5.0 and gaps[2] < 1.0, (opening, gaps)
        assert gaps[2] < gaps[1] < gaps[0]


@pytest.mark.parametrize(
    "title",
    [
        "Visemes",
        pytest.param("Action units", marks=pytest.mark.slow),
        pytest.param("ARKit shapes", marks=pytest.mark.slow),
    ],
)
def test_rows_keep_the_mesh_sound(simulation, head, title):
    """No row turns more than a few triangles over, or moves skin far away."""
    for name in simulation.controls.layers[title]:
        if name.endswith(("_left", "_right")) or name in HEAD_UNITS:
            continue
        moved = settled_displacement(simulation, {name: 1.0}, frames=45)
        assert np.abs(moved).max() < 60.0, name
        assert inverted_triangles(head.faces, head.vertices, simulation.positions) <= 6, name


def test_units_that_look_alike_differ(simulation, head):
    """Similar action units have different effects.

    AU9 pulls the nose up and the brows down over closed lips, AU10 only parts the lips; AU23
    narrows the mouth, AU24 flattens the lips.
    """
    face = {
        name: settled_displacement(simulation, {name: 1.0})[head.landmarks]
        for name in ("AU9", "AU10", "AU23", "AU24")
    }

    def parted(name):
        return float(face[name][62, 1] - face[name][66, 1])

    assert parted("AU9") < 1.0 < 4.0 < parted("AU10")
    assert face["AU9"][22, 1] < -2.0 < -0.5 < face["AU10"][22, 1]
    assert face["AU9"][35, 1] > face["AU10"][35, 1] + 1.5
    assert face["AU23"][54, 0] < -1.0 < -0.5 < face["AU24"][54, 0]
    assert face["AU24"][51, 1] < face["AU23"][51, 1] - 1.0


@pytest.mark.parametrize("sound", [sound for sound in VISEMES if sound != "sil"])
def test_speech_is_crisp(simulation, head, sound):
    """A viseme is complete after 120 ms at the lips, and overshoots by 2 % at most."""
    lips = head.landmarks[48:68]
    target = settled_displacement(simulation, {f"viseme_{sound}": 1.0}, frames=90)[lips]
    simulation.reset()
    simulation.controls.pose({f"viseme_{sound}": 1.0})
    size = float((target**2).sum())
    reached = []
    for _ in range(60):
        simulation.step(FRAME_TIME)
        moved = (simulation.positions - simulation.rest_positions)[lips]
        reached.append(float((moved * target).sum()) / size)
    assert reached[6] > 0.9, "seven frames are 117 ms"
    assert max(reached) < 1.02
