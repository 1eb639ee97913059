"""The generator still makes the head that is shipped."""

from pathlib import Path

import numpy as np
import pytest

from assets import build
from assets.loading import HEAD_FILE, load_head

TOLERANCE = 1e-3  # [mm]; other processors round differently


@pytest.fixture(scope="module")
def rebuilt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A head built now, by the command itself."""
    path = tmp_path_factory.mktemp("head") / "head.npz"
    build.main([str(path)])
    return path


def test_rebuilt_head_is_the_shipped_one(rebuilt: Path) -> None:
    """Every array: integers and names exactly, coordinates within the tolerance."""
    with np.load(rebuilt) as fresh, np.load(HEAD_FILE) as shipped:
        assert sorted(fresh.files) == sorted(shipped.files)
        for name in fresh.files:
            if np.issubdtype(fresh[name].dtype, np.floating):
                assert np.allclose(fresh[name], shipped[name], atol=TOLERANCE), name
            else:
                assert np.array_equal(fresh[name], shipped[name]), name


def test_rebuilt_head_can_be_loaded(rebuilt: Path) -> None:
    """What build writes, load reads."""
    assert len(load_head(rebuilt).faces) == 2030
