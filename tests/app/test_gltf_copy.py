"""Copies of glTF files have all data in one chunk, under unchanged names."""

import io

import PIL.Image
import pytest

from risorius.app.rig.gltf_copy import read_document
from tests.assets.gltf_files import GltfMaker


@pytest.mark.parametrize("kind", ["png", "jpeg", "webp"])
def test_a_picture_beside_a_document_keeps_its_kind(tmp_path, kind):
    """A texture that only EXT_texture_webp names stays; its image has the type image/webp."""
    content = io.BytesIO()
    PIL.Image.new("RGB", (4, 4), (250, 10, 20)).save(content, kind)
    (tmp_path / "skin").write_bytes(content.getvalue())
    maker = GltfMaker()
    image = maker.add("images", {"uri": "skin"})
    texture = {"extensions": {"EXT_texture_webp": {"source": image}}}
    maker.add("textures", texture)
    maker.view(b"numbers")
    maker.write(tmp_path / "head.glb")
    document, data = read_document((tmp_path / "head.glb").read_bytes(), tmp_path)
    assert document["textures"] == [texture]
    assert document["images"] == [{"bufferView": 1, "mimeType": f"image/{kind}"}]
    view = document["bufferViews"][1]
    assert data[view["byteOffset"] :][: view["byteLength"]] == content.getvalue()
