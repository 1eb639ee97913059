"""Fixtures shared by tests of files."""

import pytest

from tests.assets.gltf_files import GltfMaker


@pytest.fixture
def maker() -> GltfMaker:
    """A glTF maker without content."""
    return GltfMaker()
