"""Ambient occlusion: where light from all around reaches, and what it leaves of the scene."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from risorius import assets
from risorius.app.scenes import FaceScene, ambient_occlusion
from risorius.app.scenes.ambient_occlusion import DEPTH, REVEALED, main, open_to_light
from risorius.app.scenes.mouth import shaded_mouth
from risorius.assets.loading import HEAD_FILE, load_head
from tests import meshes


@pytest.fixture
def unbaked(tmp_path: Path) -> FaceScene:
    """The same head from another place, where no light was baked for it."""
    for name in ("head.npz", "head.png", "head_wrinkles.npz", "head_finer.npz"):
        shutil.copy(HEAD_FILE.with_name(name), tmp_path)
    return FaceScene(load_head(tmp_path / "head.npz"))


def test_outside_and_inside_of_a_ball() -> None:
    """Nothing stands around a ball; inside, every ray ends at the other side."""
    ball = meshes.octahedron()
    faces = ball.faces.astype(np.int32)
    for size in (4.0, 16.0):
        positions = size * ball.vertices
        assert open_to_light(positions, faces, np.arange(6)).min() > 0.999
        inside = open_to_light(positions, faces[:, ::-1].copy(), np.arange(6))
        # From a corner of an octahedron to the other side: between an edge and a diagonal.
        assert np.ptp(inside) < 0.05
        assert inside.max() < 2.0 * size / 45.0


def test_shipped_light_is_what_the_program_makes() -> None:
    """What rays find on the finest mesh is in the picture: it belongs to the shipped head."""
    head = assets.load("head")
    fine = head.finer(2)
    some = np.arange(0, len(fine.vertices), 200)
    found = open_to_light(fine.vertices, fine.faces, some)
    size = len(head.ambient_occlusion)
    places = fine.interpolate(head.uv)[some] * [size, -size] + [0, size]
    columns, rows = places.astype(int).clip(0, size - 1).T
    shipped = head.ambient_occlusion[rows, columns] / 255.0
    is_at_rest = found > REVEALED  # what is darker may be as it is with the mouth open
    difference = np.abs(shipped - found**DEPTH)[is_at_rest]
    assert is_at_rest.mean() > 0.5 and (difference < 0.04).mean() > 0.9
    assert (shipped > found**DEPTH - 0.1).mean() > 0.9


def test_program_writes_the_light_of_a_head(
    unbaked: FaceScene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside the data file that it is given, to be read from there; here by a single ray."""
    monkeypatch.setattr(ambient_occlusion, "RAYS", 1)
    head = unbaked.head
    assert isinstance(head, assets.Head) and not head.ambient_occlusion_file.exists()
    main([str(head.ambient_occlusion_file.with_name("head.npz"))])
    assert np.array_equal(unbaked.ambient_occlusion(), head.ambient_occlusion)
    np.savez(
        head.ambient_occlusion_file, ambient_occlusion=head.ambient_occlusion, made_from=np.array(1)
    )
    with pytest.raises(
        assets.AssetError,
        match=r"another head; .* 'python -m .*ambient_occlusion'",
    ):
        _ = load_head(head.ambient_occlusion_file.with_name("head.npz")).ambient_occlusion
    head.ambient_occlusion_file.write_bytes(b"nothing")
    with pytest.raises(
        assets.AssetError,
        match=r"not a readable npz .* 'python -m .*ambient_occlusion'",
    ):
        _ = load_head(head.ambient_occlusion_file.with_name("head.npz")).ambient_occlusion


def test_a_mouth_gets_darker_toward_the_back(face: FaceScene) -> None:
    """Molars lose more than incisors, eyes nothing."""
    head, shown = face.head.parts, face.parts
    for given, drawn in zip(head, shown, strict=True):
        if given.name.startswith("eye"):
            assert drawn is given
        elif given.name.startswith("teeth"):
            left = (drawn.colours / given.colours).mean(axis=1)
            assert left[given.vertices[:, 2].argmax()] > 0.9
            assert left[given.vertices[:, 2].argmin()] < 0.9
    lower = {part.name: part.colours for part in shown}["teeth_lower"]
    given = {part.name: part for part in head}["teeth_lower"]
    red, _, blue = (lower / given.colours)[given.vertices[:, 2].argmin()]
    assert blue < 0.75 and blue < 0.95 * red  # grey ones look like one broken tooth
    assert shaded_mouth(()) == ()
