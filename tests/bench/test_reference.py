"""Conversion of a checkout of ICT-FaceKit to reference data; the tests write a small checkout."""

import gzip
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from risorius.bench import reference
from tests.app.command_line import risorius, succeeded

CELL_COUNT = 40  # cells along a side of the face
VERTEX_COUNT = (CELL_COUNT + 1) ** 2  # vertices of the face
LIFT_VECTOR = np.array([0.0, 0.5, 0.25])


def face():
    """A dome of quads, and one more vertex behind it, which the last quad uses."""
    x, y = np.meshgrid(*[np.linspace(-8.0, 8.0, CELL_COUNT + 1)] * 2)
    z = 8.0 - 0.05 * (x**2 + y**2) + 0.1 * np.sin(3.0 * x)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    rows = np.arange(VERTEX_COUNT).reshape(CELL_COUNT + 1, -1)
    corners = [rows[:-1, :-1], rows[:-1, 1:], rows[1:, 1:], rows[1:, :-1]]
    quads = np.stack(corners, axis=-1).reshape(-1, 4)
    behind = [[VERTEX_COUNT, 0, 1, 2]]
    return np.vstack([vertices, [[0.0, 0.0, -9.0]]]), np.vstack([quads, behind])


def obj(vertices, quads):
    """The text of an OBJ file as in the checkout, with texture coordinates."""
    places = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices]
    polygons = [f"f {a}/1 {b}/1 {c}/1 {d}/1" for a, b, c, d in quads + 1]
    lines = ["# a head", *places, "vt 0 0", *polygons]
    return "\n".join(lines).encode()


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout: neutral head, two expressions, one component, licence and README.

    One of the files is packed.
    """
    monkeypatch.setattr(reference, "FACE_VERTICES", VERTEX_COUNT)
    model = tmp_path / "checkout" / "FaceXModel"
    model.mkdir(parents=True)
    vertices, quads = face()
    (model / "generic_neutral_mesh.obj").write_bytes(obj(vertices, quads))
    (model / "jawOpen.obj").write_bytes(obj(vertices + LIFT_VECTOR, quads))
    (model / "mouthSmile_L.obj.gz").write_bytes(gzip.compress(obj(vertices - LIFT_VECTOR, quads)))
    (model / "identity000.obj").write_bytes(obj(1.01 * vertices, quads))
    (model.parent / "LICENSE").write_text("as you like")
    numbers = ", ".join(map(str, range(68)))
    (model.parent / "README.md").write_text(f"Landmarks:\n\n    {numbers}\n\nJaw:\n\n    1, 2\n")
    return model.parent


def made(checkout):
    """The arrays written by the command, by file name."""
    folder = checkout.parent / "made"
    said = succeeded("bench", "reference", checkout, "-o", folder)
    assert "not in the checkout: mouthSmile_R" in said
    assert (folder / "LICENSE").read_text() == "as you like"
    return {path.stem: dict(np.load(path)) for path in folder.glob("*.npz")}


def test_the_face_and_its_motion(checkout):
    """Vertices are unchanged, quads become fans, and motion is a difference of positions.

    Everything of the head but the face is left out.
    """
    vertices, quads = face()
    arrays = made(checkout)["face"]
    assert set(arrays) == {"vertices", "triangles", "landmarks68", "jawOpen", "mouthSmile_L"}
    assert_allclose(arrays["vertices"], vertices[:-1], atol=1e-5)
    a, b, c, d = quads[0].tolist()
    assert arrays["triangles"][:2].tolist() == [[a, b, c], [a, c, d]]
    assert len(arrays["triangles"]) == 2 * CELL_COUNT**2  # none that reaches behind the face
    assert_allclose(arrays["jawOpen"], np.tile(LIFT_VECTOR, (VERTEX_COUNT, 1)), atol=2e-6)
    assert_allclose(arrays["mouthSmile_L"], -arrays["jawOpen"], atol=2e-6)
    assert arrays["landmarks68"].tolist() == list(range(68))


def test_identity_modes(checkout):
    """Each identity mode is the motion of the face by its component."""
    files = made(checkout)
    assert files["identity_modes"]["modes"].shape == (1, VERTEX_COUNT, 3)
    expected = 0.01 * files["face"]["vertices"]
    assert_allclose(files["identity_modes"]["modes"][0], expected, atol=1e-5)


@pytest.mark.slow
def test_bench_quality_runs_on_it(checkout):
    """`bench quality --reference` accepts the folder."""
    made(checkout)
    result = risorius("bench", "quality", "--reference", checkout.parent / "made")
    assert result.exit_code in (0, 1), result.output  # targets are for faces; this is a dome
    rows = [line for line in result.output.splitlines() if line.startswith("cubic twice ")]
    triangles, _, better = rows[0].removeprefix("cubic twice").split()[:3]
    assert float(triangles) > 10 and float(better.rstrip("%")) > 50, "nearer to the dense face"


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda folder: (folder / "README.md").unlink(), "has no list of 68 landmarks"),
        (
            lambda folder: (folder / "FaceXModel/jawOpen.obj").write_text("v 0 0 0\nf 1 1 1\n"),
            "jawOpen has other vertices than the neutral head",
        ),
        (lambda folder: (folder / "FaceXModel/jawOpen.obj").write_text("v 0 x 0\n"), "line 1"),
        (
            lambda folder: (folder / "FaceXModel/mouthSmile_L.obj.gz").write_text("no"),
            "smile_l.obj.gz",
        ),
        (
            lambda folder: (folder / "FaceXModel/generic_neutral_mesh.obj").unlink(),
            "must be a checkout of ICT-FaceKit",
        ),
    ],
)
def test_a_broken_checkout_is_reported_in_one_line(checkout, spoil, words):
    """One line names the broken file, and nothing is written."""
    spoil(checkout)
    result = risorius("bench", "reference", checkout, "-o", checkout.parent / "made")
    assert result.exit_code == 2
    assert words.lower() in result.stderr.lower()
    assert len(result.stderr.strip().splitlines()) == 1
    assert not (checkout.parent / "made" / "face.npz").exists()
