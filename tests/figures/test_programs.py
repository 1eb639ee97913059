"""The programs that draw the documentation's pictures."""

import numpy as np
import refinement


def test_line_drawings():
    """Each drawing for the page on refinement has lines."""
    for figure in (refinement.cases, refinement.lookup):
        assert 0.01 < (figure().min(axis=2) < 128).mean() < 0.8
    assert np.array_equal(refinement.cases(), refinement.cases())
