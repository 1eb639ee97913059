"""The walls of the mouth stay inside the head: in turned heads, with open jaws, on masks."""

from collections.abc import Iterator
from itertools import product

import numpy as np
import PIL.Image
import PIL.ImageDraw
import pytest
from numpy.linalg import norm
from scipy.ndimage import binary_dilation
from scipy.spatial import ConvexHull

from risorius import assets, render
from risorius.app.passes.camera import CameraLabels
from risorius.app.passes.passes import Passes
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene
from risorius.app.scenes.mouth import MouthWalls
from risorius.assets import Segment
from risorius.assets.fitting import fit
from risorius.assets.meshes import Mesh
from risorius.geometry.numbering import places_among
from risorius.geometry.transforms import moved_points
from tests.heads import person_of

SIZE = (300, 300)
JAW_POSES = ({}, {"jaw_open": 1.0}, {"jaw_open": 0.7, "jaw_sideways": 1.0})
HEAD_TURNS = tuple(
    dict(zip(("head_pitch", "head_yaw", "head_roll"), signs, strict=True))
    for signs in product((-1.0, 1.0), repeat=3)
)


@pytest.fixture(scope="module")
def renderer() -> Iterator[render.Renderer]:
    """A renderer of small pictures."""
    with render.open_offscreen(SIZE, samples=1) as surface:
        yield render.Renderer(surface)


class Sitter:
    """A face before a camera."""

    def __init__(self, scene, renderer):
        self.scene = scene
        self.surface = renderer.surface
        self.pipeline = Pipeline(scene, renderer)
        self.drawn = self.pipeline.bind(Refinement(refiner="none"))
        self.passes = Passes(self.pipeline, self.drawn)

    def outside_lips(self, yaw, pitch):
        """The number of pixels outside the lips' outline that show the mouth's inside."""
        scene = self.scene
        camera = render.OrbitCamera.framing(scene.rest_positions, view="front")
        camera.orbit(yaw, pitch)
        camera.fit(scene.positions, 0.02)
        self.pipeline.draw(camera, render.Style(), [Viewport(self.drawn, (0, 0, *SIZE))])
        classes = self.passes.draw(camera, render.Style(), {"segmentation"})["segmentation"]
        places = CameraLabels.from_camera(camera, SIZE).project(
            scene.positions[scene.landmarks[48:60]]
        )
        outline = places[ConvexHull(places).vertices]
        lips = PIL.Image.new("1", SIZE)
        PIL.ImageDraw.Draw(lips).polygon([tuple(place) for place in outline.tolist()], fill=1)
        within = binary_dilation(np.asarray(lips))  # larger by the pixel of the outline
        return int(((classes == Segment.MOUTH_INTERIOR) & ~within).sum())


@pytest.mark.slow
def test_nothing_of_the_mouth_pierces_the_throat(renderer):
    """For thirty persons with turned heads, no wall of the mouth pierces the throat.

    Heads turn to their limits, jaws are shut, open and aside, and the camera looks from below.
    """
    found = {}
    for number in (*range(28), 63, 189):
        sitter = Sitter(FaceScene(person_of(number)), renderer)
        for k, jaw in enumerate(JAW_POSES):
            sitter.scene.reset()
            for turn in (HEAD_TURNS[(number + k) % 8], HEAD_TURNS[(number + k + 3) % 8]):
                # At the limits, and half way, as a person who looks around.
                for share in (1.0, 0.5):
                    pose = {name: share * value for name, value in turn.items()}
                    sitter.scene.pose({**jaw, **pose})
                    sitter.scene.step(0.6)
                    for view in ((0.0, -8.0), (40.0 if number % 2 else -40.0, -8.0)):
                        if count := sitter.outside_lips(*view):
                            found[number, *jaw, *pose.values(), view] = count
    assert found == {}


def mask(lowest):
    """The front of the built-in head without neck and ears, cut along the jaw at `lowest` [mm]."""
    head = assets.load("head")
    _, y, z = head.vertices[head.faces].mean(axis=1).T
    jaw = lowest + 0.5 * np.maximum(70.0 - z, 0.0)
    faces = head.faces[(y < 60.0) & (z > 12.0) & (y > jaw)]
    used = np.unique(faces)
    places = places_among(used, len(head.vertices))
    return fit(Mesh(head.vertices[used], places[faces]), places[head.landmarks])


def seen_from_in_front(sitter, pitches):
    """For each view, the pixels beside the lips that show the mouth's inside, if any."""
    views = product((-80.0, -40.0, 0.0, 40.0, 80.0), pitches)
    counts = {view: sitter.outside_lips(*view) for view in views}
    return {view: count for view, count in counts.items() if count}


@pytest.mark.slow
@pytest.mark.parametrize("lowest", [-118.0, -113.0])
def test_nothing_hangs_below_a_mask(renderer, lowest):
    """A skin without a neck hides the inside of its mouth, at rest and with an open jaw.

    The inside is visible only from below and with an open jaw.
    """
    sitter = Sitter(FaceScene(mask(lowest)), renderer)
    assert seen_from_in_front(sitter, (-10.0, 0.0, 20.0)) == {}
    sitter.scene.pose({"jaw_open": 0.5})
    sitter.scene.step(0.6)
    assert seen_from_in_front(sitter, (0.0, 20.0)) == {}


def test_a_mask_has_no_neck_that_fades():
    """The border of a mask surrounds the face, so that no part of its chin is transparent."""
    assert mask(-118.0).fade() is None


def lower_edge(walls):
    """Current places of the wall vertices that follow the mandible most."""
    return walls.vertices[walls.mandible_shares > 0.9]


def test_walls_stretch_with_the_jaw(face):
    """The walls' edge follows the mandible, and their root the skull; at rest nothing changes."""
    face.reset()
    walls = next(part for part in face.parts if isinstance(part, MouthWalls))
    rest = walls.vertices
    edge = lower_edge(walls)
    face.pose({"head_yaw": 0.8, "head_pitch": -0.5})
    face.step(0.5)
    assert face.parts and walls.vertices is rest  # moved by a bone only
    face.pose({"jaw_open": 1.0})
    face.step(0.8)
    assert face.parts
    assert walls.vertices is not rest
    mandible = face.bone_transforms()["mandible"]
    moved = moved_points(mandible, edge)
    assert norm(lower_edge(walls) - moved, axis=1).max() < 2.5
    fixed = walls.mandible_shares == 0.0
    assert np.array_equal(walls.vertices[fixed], rest[fixed])
    assert np.allclose(norm(walls.normals, axis=1), 1.0, atol=1e-4)
    stretched = walls.vertices
    assert face.parts
    assert walls.vertices is stretched
    face.reset()
    assert face.parts
    assert walls.vertices is rest


def test_walls_end_above_the_chin(face):
    """Walls end above the chin, because skin below it does not follow the head fully.

    A deeper wall would pierce that skin.
    """
    for head in (face.head, person_of(63), person_of(6)):
        chin = head.vertices[head.landmarks[8], 1]
        walls = [part.vertices for part in head.parts if part.name.startswith("oral_cavity")]
        assert len(walls) == 2
        assert np.vstack(walls)[:, 1].min() > chin + 8.0
