"""Content of a glTF document: ignored, refused, or in files beside it."""

import base64

import numpy as np
import pytest

from risorius import assets
from risorius.assets import AssetError
from tests.assets.gltf_square import (
    FACES,
    RED,
    SQUARE,
    UP_UV,
    UV,
    material,
    painted,
    png,
    read,
    shape_of,
    show_square,
    uv_of,
)


def _extras(maker):
    maker.parts["extras"] = "any"
    maker.parts["nodes"][0]["extras"] = [1, 2]
    maker.parts["meshes"][0]["extras"] = 5


def _unknown(maker):
    maker.parts["extensionsUsed"] = ["ACME_wind"]
    maker.parts["extensions"] = {"ACME_wind": {"from": "east"}}
    maker.parts["cameras"] = [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1}}]
    maker.parts["animations"] = [{"channels": [], "samplers": []}]


def _draco_beside(maker):
    """Draco data, and uncompressed numbers beside it for readers that cannot decode Draco."""
    maker.parts["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    primitive = maker.parts["meshes"][0]["primitives"][0]
    primitive["extensions"] = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}


@pytest.mark.parametrize("change", [_extras, _unknown, _draco_beside])
def test_unneeded_content_is_ignored(maker, tmp_path, change):
    """Unknown extras, optional extensions, and cameras are ignored."""
    show_square(maker)
    change(maker)
    assert np.allclose(shape_of(read(maker, tmp_path)), SQUARE[FACES])


def _required(name):
    def change(maker):
        maker.parts["extensionsRequired"] = [name]

    return change


def _no_data(maker):
    maker.parts["bufferViews"][0]["buffer"] = 1
    maker.parts["buffers"] = [{"byteLength": len(maker.data)}, {"byteLength": 48}]


def _elsewhere(maker):
    _no_data(maker)
    maker.parts["buffers"][1]["uri"] = "../../etc/passwd"


def _lost(maker):
    _no_data(maker)
    maker.parts["buffers"][1]["uri"] = "head%20data.bin"


def _old(maker):
    maker.parts["asset"]["version"] = "1.0"


def _huge(maker):
    maker.parts["accessors"][0] = {"componentType": 5126, "count": 10**10, "type": "VEC3"}


def _beyond(maker):
    maker.parts["accessors"][0]["count"] = 5000


def _circle(maker):
    maker.parts["nodes"][0]["children"] = [0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_required("ACME_wind"), "needs the extension ACME_wind, which is not read here; export"),
        (_no_data, "its buffer 1 is missing; export it as one file"),
        (_elsewhere, "names the file '../../etc/passwd'; it must lie in the mesh's folder"),
        (_lost, "its buffer head data.bin: no such buffer file"),
        (_old, "is glTF 1.0; export it as glTF 2.0"),
        (_huge, "an accessor of 10000000000 rows; allowed are"),
        (_beyond, "broken, or named as another format"),
        (_circle, "broken, or named as another format"),
    ],
)
def test_unreadable_content_is_named(maker, tmp_path, change, message):
    """Each unreadable content gives one clear line."""
    show_square(maker)
    change(maker)
    with pytest.raises(AssetError, match=message) as refusal:
        read(maker, tmp_path)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("is_beside", [True, False])
def test_a_document_may_have_its_data_beside_it(maker, tmp_path, is_beside):
    """A .gltf file has data and picture in other files, or as text within it."""
    painted(maker, maker.accessor(UV))
    image = maker.parts["images"][0]
    del image["bufferView"]
    inline = "data:application/octet-stream;base64," + base64.b64encode(maker.data).decode()
    image["uri"] = (
        "my skin.png" if is_beside else f"data:;base64,{base64.b64encode(png()).decode()}"
    )
    (tmp_path / "my skin.png").write_bytes(png())
    (tmp_path / "head data.bin").write_bytes(maker.data)
    path = tmp_path / "head.gltf"
    path.write_bytes(maker.document(uri="head%20data.bin" if is_beside else inline))
    found = assets.read_mesh(path)
    assert np.allclose(shape_of(found), SQUARE[FACES])
    assert np.allclose(uv_of(found), UP_UV[FACES])
    assert found.texture.pictures[0]()[0, 0].tolist() == list(RED)


@pytest.mark.parametrize("name", ["Haut für 顔.png", "Haut%20f%C3%BCr%20%E9%A1%94.png"])
def test_a_picture_beside_it_may_have_any_letters(maker, tmp_path, name):
    """A file name beside the .gltf file may be plain or percent-encoded, with any letters."""
    painted(maker, maker.accessor(UV))
    image = maker.parts["images"][0]
    del image["bufferView"]
    image["uri"] = name
    (tmp_path / "Haut für 顔.png").write_bytes(png())
    (tmp_path / "data.bin").write_bytes(maker.data)
    path = tmp_path / "頭 ü.gltf"
    path.write_bytes(maker.document(uri="data.bin"))
    assert assets.read_mesh(path).texture.pictures[0]()[0, 0].tolist() == list(RED)


def test_pictures_of_a_kind_that_is_not_read_are_named(maker, tmp_path):
    """A picture in an unknown format is reported only when it is drawn.

    Hair may have a format other than the skin's.
    """
    texture = maker.add("textures", {"extensions": {"EXT_texture_avif": {"source": 0}}})
    number = material(maker, {"index": texture})
    show_square(maker, {"TEXCOORD_0": maker.accessor(UV)}, material=number)
    maker.parts["extensionsRequired"] = ["EXT_texture_avif"]
    found = read(maker, tmp_path)
    with pytest.raises(AssetError, match="not read \\(EXT_texture_avif\\); save it as PNG"):
        found.texture.pictures[0]()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bufferView": 99}, "its picture 0 is not in it"),
        ({"bufferView": 0}, "its picture face: is broken, too large, or neither PNG, JPEG nor"),
        ({"bufferView": None, "uri": "lost.png"}, r"its picture lost\.png: no such picture file"),
        ({"bufferView": None, "uri": "../a.png"}, r"names the file '\.\./a\.png'; it must lie in"),
    ],
)
def test_pictures_that_cannot_be_read_are_named(maker, tmp_path, change, message):
    """A broken picture is reported in one line when it is drawn."""
    painted(maker, maker.accessor(UV))
    maker.parts["images"][0].update({"name": "face", **change})
    found = read(maker, tmp_path)
    with pytest.raises(AssetError, match=message):
        found.texture.pictures[0]()
