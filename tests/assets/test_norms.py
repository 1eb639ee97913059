"""The built-in head compared with published norms, and the page with both."""

from pathlib import Path

import numpy as np
import pytest

from risorius.assets.model import Head
from risorius.assets.norms import NORMS, NormSample, measures_of

LEBANON_2018 = "87 men, 135 women, doi 10.1016/j.forsciint.2018.10.021"
TOMOGRAPHY_2015 = "18 women, doi 10.2319/040114-237.1"

DEPTHS = {
    "rhinion": (NormSample(3.07, 0.72), LEBANON_2018),
    "subnasale": (NormSample(15.61, 2.38), LEBANON_2018),
    "labiale_superius": (NormSample(13.31, 2.01), TOMOGRAPHY_2015),
    "labiale_inferius": (NormSample(15.08, 1.94), TOMOGRAPHY_2015),
    "pogonion": (NormSample(14.69, 3.08), TOMOGRAPHY_2015),
}
"""Anatomical name: published depth of bone [mm] and its source; no other figure could be read.

Each was read in the abstract of its study: "Facial soft tissue of Lebanese adults with
well-balanced faces", cephalograms; soft tissue of the lower anterior face by cone-beam tomography,
Angle Orthodontist 85:211-217, persons with a normal vertical pattern.
"""


@pytest.fixture(scope="module")
def measures(head: Head) -> dict[str, float]:
    """The measures of the head."""
    return measures_of(head.vertices, head.anatomy)


@pytest.fixture(scope="module")
def page() -> str:
    """The documentation's page about the head."""
    return (Path(__file__).parents[2] / "docs" / "head.md").read_text(encoding="utf-8")


def test_head_is_usual_in_every_measure_with_a_norm(measures):
    """All measures are within two deviations of the published means of women and of men."""
    for code, norm in NORMS.items():
        for sample in (norm.women, norm.men):
            assert abs(sample.score(measures[code])) <= 2.0, code
    assert 9.0 < measures["ps-pi"] < 12.0  # the eyes are open


def test_head_is_near_the_middle_on_the_whole(measures):
    """On average, the scores of all measures are near 0."""
    scores = [
        0.5 * (norm.women.score(measures[code]) + norm.men.score(measures[code]))
        for code, norm in NORMS.items()
    ]
    assert abs(float(np.mean(scores))) < 0.6
    assert float(np.sqrt(np.mean(np.square(scores)))) < 1.0


def test_lips_lie_a_little_behind_the_line_from_nose_to_chin(head, page):
    """Both lips lie a little behind the line from nose to chin (Ricketts).

    Lips of three scanned persons lie -4 to 9 mm behind the line.
    """
    middle = head.vertices[head.vertices[:, 0] == 0.0]
    tip, chin, seam = (
        head.vertices[head.anatomy[name]] for name in ("pronasale", "pogonion", "stomion")
    )
    along = (chin - tip) / np.linalg.norm(chin - tip)
    behind = (middle - tip) @ [0.0, -along[2], along[1]]
    is_upper = (middle[:, 1] > seam[1]) & (middle[:, 1] < seam[1] + 10.0)
    is_lower = (middle[:, 1] < seam[1]) & (middle[:, 1] > seam[1] - 12.0)
    in_front = middle[:, 2] > 80.0
    upper, lower = (float(behind[lip & in_front].min()) for lip in (is_upper, is_lower))
    assert 0.5 < lower < upper < 7.0
    assert f"{upper:.1f} and {lower:.1f} mm behind the line" in page


def test_norms_are_plausible_figures():
    """The norms have no typing mistakes: deviations are 3 to 25 %, and men are larger."""
    for code, norm in NORMS.items():
        assert norm.men.mean > norm.women.mean, code
        for sample in (norm.women, norm.men):
            assert 0.03 < sample.deviation / sample.mean < 0.25, code


def test_the_page_shows_the_measures_and_the_norms(measures, page):
    """The page has every measure, with scores where there is a norm."""
    for code, value in measures.items():
        row = f", {code} | {value:.1f} |"
        for sample in (NORMS[code].women, NORMS[code].men) if code in NORMS else ():
            score = f"{sample.score(value):+.1f}"
            row += f" {sample.mean:.1f} ± {sample.deviation:.1f} | {score} |"
        assert row in page


def test_bone_lies_as_deep_as_was_published(head, page):
    """Bone depths are within two deviations of every published figure; the page has each figure."""
    for name, (sample, source) in DEPTHS.items():
        depth = float(head.bone_depth[head.anatomy[name]])
        assert abs(sample.score(depth)) < 2.0, name
        published = f"{sample.mean:.1f} ± {sample.deviation:.1f} | {sample.score(depth):+.1f}"
        assert f"{name.replace('_', ' ')} | {depth:.1f} | {published} | {source} |" in page
