"""The generated women and men compared with published means."""

from pytest import approx

from risorius.bench import persons


def test_sexes_lie_as_far_apart_as_published():
    """Thirty measurements differ between women and men as published, less the calipers' pressure.

    Every norm has a line.
    """
    rows = persons.measure(30)
    assert [target.is_met for target in persons.targets(rows)] == [True]
    text = persons.report(rows)
    for row in rows:
        assert f"\n{row.code:<8}" in text
    jaw = next(row for row in rows if row.code == "go-go")
    assert (jaw.published_women, jaw.published_difference) == (97.0, approx(6.7))
    assert jaw.women == approx(97.0, abs=5.0)
