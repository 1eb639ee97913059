"""The programs that draw the documentation obey the rules of the command."""

import numpy as np
import refinement


def test_line_drawings():
    """There is ink on each of the page on refinement."""
    for figure in (refinement.cases, refinement.lookup):
        assert 0.01 < (figure().min(axis=2) < 128).mean() < 0.8
    assert np.array_equal(refinement.cases(), refinement.cases())
