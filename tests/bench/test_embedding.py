"""The benchmark of fine meshes carried by a coarse one."""

from risorius.bench import embedding


def test_three_times_nearer_than_flat_binding():
    """For a bent plane, sphere and cylinder the error is at most a third of flat binding's."""
    rows = embedding.measure()
    assert {row.surface for row in rows} == {"plane", "sphere", "cylinder"}
    assert all(3.0 * row.ours < row.with_offset for row in rows)
    assert all(row.with_offset < 1.001 * row.without_offset for row in rows)
    assert all(target.is_met for target in embedding.targets(rows))
    assert "flat + offset by ours" in embedding.report(rows)
