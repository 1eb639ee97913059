"""Every odd head gives a mesh, a head, or a one-line error, in limited time and memory."""

import re
import warnings
from contextlib import contextmanager

import numpy as np
import pytest

from risorius.assets import AssetError
from risorius.assets.fitting import FittedHead
from risorius.assets.meshes import Mesh

from .head_inputs import Kind, head_inputs, open_head_files
from .sandbox import bounded

pytestmark = pytest.mark.slow

LONGEST_RUN = 10.0  # [s] on a busy machine; the slowest takes 1 s on an idle one
MOST_MEMORY = 400_000_000  # [bytes] above the memory before the input


@contextmanager
def quiet_and_bounded():
    """Fail if the work takes too much time or memory, or prints a warning.

    An underflow is silent, as in numpy by default, because it depends on the processor.
    """
    with warnings.catch_warnings(record=True) as caught, np.errstate(all="warn", under="ignore"):
        warnings.simplefilter("always")
        with bounded(LONGEST_RUN, MOST_MEMORY):
            yield
    shown = [str(w.message) for w in caught if not issubclass(w.category, DeprecationWarning)]
    assert shown == []


@pytest.mark.parametrize("odd", head_inputs(), ids=lambda odd: odd.name)
def test_odd_heads(odd, tmp_path, capfd):
    """The result is as in the table; a refusal is one line that names the file."""
    brought = odd.write(tmp_path)
    if isinstance(odd.expected, str):
        with quiet_and_bounded(), pytest.raises(AssetError) as refusal:
            open_head_files(brought)
        message = str(refusal.value)
        assert message.isprintable()
        assert len(message) < 500
        assert str(tmp_path) in message
        assert re.search(odd.expected, message), message
    else:
        with quiet_and_bounded():
            found = open_head_files(brought)
        assert isinstance(found, Mesh if odd.expected is Kind.MESH else FittedHead)
        assert np.isfinite(found.vertices).all()
        assert 0 <= found.faces.min()
        assert found.faces.max() < len(found.vertices)
    assert capfd.readouterr() == ("", "")
