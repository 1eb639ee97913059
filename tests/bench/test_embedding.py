"""The benchmark of fine meshes carried by a coarse one."""

from risorius.bench import embedding


def test_three_times_nearer_than_flat_binding():
    """A plane, a sphere and a cylinder, bent: at most a third of the error of flat binding."""
    rows = embedding.measure()
    assert {row.surface for row in rows} == {"plane", "sphere", "cylinder"}
    assert all(3.0 * row.ours < row.with_offset for row in rows)
    assert all(row.with_offset < 1.001 * row.without_offset for row in rows)
    assert all(target.is_met for target in embedding.targets(rows))
    assert "flat + offset by ours" in embedding.report(rows)
