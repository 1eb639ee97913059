"""The mesh report and the published norms in it."""

from pathlib import Path

import numpy as np
import pytest

from risorius import assets
from risorius.assets.model import Head
from risorius.assets.norms import DEPTHS, NORMS, WEINBERG_2016, Norm, Sample
from risorius.assets.report import depth_table, distance_rows, distance_table, main, mesh_table


@pytest.fixture(scope="module")
def head() -> Head:
    """The built-in head."""
    return assets.load("head")


def test_every_norm_is_measured(head: Head) -> None:
    """No published figure lies unused, and codes in titles are spelt as the norms' are."""
    measured = [row.title.rpartition(", ")[2] for row in distance_rows(head) if row.norm]
    assert sorted(measured) == sorted(NORMS)


def test_head_is_usual_in_every_measure_with_a_norm(head: Head) -> None:
    """Within two deviations of the mean of women and of men: so it was when the norms came in."""
    for row in distance_rows(head):
        if row.norm is not None:
            assert row.norm.usual_for(row.value) == "both", row


def test_head_is_near_the_middle_on_the_whole(head: Head) -> None:
    """Usual in each measure is not enough: between the sexes the scores must not pile up."""
    scores = [
        0.5 * (row.norm.women.score(row.value) + row.norm.men.score(row.value))
        for row in distance_rows(head)
        if row.norm is not None
    ]
    assert abs(float(np.mean(scores))) < 0.6
    assert float(np.sqrt(np.mean(np.square(scores)))) < 1.0


def test_norms_are_plausible_figures() -> None:
    """Against slips of the pen: deviations of 4 to 25 %, men larger, large samples."""
    for code, norm in NORMS.items():
        assert norm.men.mean > norm.women.mean, code
        for sample in (norm.women, norm.men):
            assert 0.03 < sample.deviation / sample.mean < 0.25, code
            assert sample.size > 800, code


def test_usual_means_two_deviations() -> None:
    """Scores and verdicts of a made-up norm."""
    norm = Norm(Sample(30.0, 2.0, 10), Sample(35.0, 2.0, 10))
    assert norm.women.score(33.0) == pytest.approx(1.5)
    verdicts = [norm.usual_for(value) for value in (25.0, 28.0, 32.5, 38.0, 40.0)]
    assert verdicts == ["nobody", "women", "both", "men", "nobody"]


def test_command_writes_all_tables_and_the_source(
    head: Head, capsys: pytest.CaptureFixture[str]
) -> None:
    """What `python -m risorius.assets.report` prints; the page holds both tables of the face."""
    main()
    written = capsys.readouterr().out
    tables = ["\n".join(make(head)) for make in (mesh_table, distance_table, depth_table)]
    assert written.startswith("\n\n".join(tables))
    assert "| triangles | 2030 |" in tables[0] and written.rstrip().endswith(f"{WEINBERG_2016}.")
    page = (Path(__file__).parents[2] / "docs" / "head.md").read_text(encoding="utf-8")
    for table in tables[1:]:
        assert table in page


def test_bone_lies_as_deep_as_was_published(head: Head) -> None:
    """Within two deviations wherever a figure could be read; every figure is in the table."""
    lines = depth_table(head)
    for name, (sample, source) in DEPTHS.items():
        assert abs(sample.score(float(head.bone_depth[head.anatomy[name]]))) < 2.0, name
        assert any(source in text and f"{sample.mean:.1f}" in text for text in lines), name
