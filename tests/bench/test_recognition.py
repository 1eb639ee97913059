"""The benchmark of face recognition: its measures, and the message without dlib's files."""

import numpy as np
import pytest
from pytest import approx

from risorius.app.errors import UserError
from risorius.bench import landmarks, recognition
from tests.app.command_line import succeeded


def test_distances_and_components_of_known_descriptions():
    """Faces along two directions have two components; pairs closer than 0.6 are counted."""
    descriptions = np.zeros((4, 128))
    descriptions[:, 3] = 0.0, 1.0, 0.0, 1.0
    descriptions[:, 7] = 0.0, 0.0, 0.5, 0.5
    assert recognition.component_count(descriptions) == 2
    diagonal = 1.25**0.5
    expected = [0.5, 0.5, 1.0, 1.0, diagonal, diagonal]
    assert sorted(recognition.distances(descriptions)) == approx(expected)
    texts = [str(target) for target in recognition.targets(descriptions)]
    assert "0.3333, at most 0.55" in texts[1]
    assert texts[2].split()[0] == "MISSED"


def test_persons_without_a_found_face_are_left_out():
    """A picture in which no face is found gives no description."""
    answers = iter([None, np.ones(128)])
    found = recognition.measure(range(2), lambda picture: next(answers))
    assert found.shape == (1, 128)


def test_without_dlib_one_line_says_so(monkeypatch):
    """dlib is an optional extra: its absence is reported in one line."""
    monkeypatch.setattr(landmarks, "is_installed", lambda name: False)
    output = succeeded("bench", "recognition", "--count", 20)
    assert output == "skipped: dlib is not installed; pip install '.[dlib]' brings it\n"


def test_another_file_is_no_model(tmp_path):
    """A file that dlib cannot read is refused in one line."""

    def shape_predictor(file):
        raise RuntimeError("Unexpected version")

    file = tmp_path / "other.dat"
    with pytest.raises(UserError, match=r"other\.dat: is no shape_predictor of dlib"):
        landmarks.model_of_dlib(shape_predictor, file)
