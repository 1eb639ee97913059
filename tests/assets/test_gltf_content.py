"""Compressed glTF is read like the same file without compression."""

import base64
import json
import sys
import zlib

import numpy as np
import pytest

from risorius import assets
from risorius.app.rig.gltf_copy import read_document
from risorius.assets import AssetError
from tests.assets.gltf_files import GltfMaker

meshopt = pytest.importorskip("meshopt", reason="needs the extra 'compression'")
draco = pytest.importorskip("DracoPy", reason="needs the extra 'compression'")
MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
DRACO = "KHR_draco_mesh_compression"
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint16)


def compressed_by_meshopt(name=MESHOPT[0], *, fallback=None):
    """A square whose places and triangles meshopt compresses; fallback: its second buffer."""
    maker = GltfMaker()
    views = []
    for rows, mode in ((SQUARE, "ATTRIBUTES"), (FACES.reshape(-1, 1), "TRIANGLES")):
        data = meshopt.encode_gltf_buffer(rows, mode)
        number = maker.view(bytes(data))
        packed = maker.parts["bufferViews"][number]
        stride = rows.shape[1] * rows.itemsize
        packed |= {"mode": mode, "count": len(rows), "byteStride": stride}
        views.append(
            {
                "buffer": 1,
                "byteOffset": 48 * len(views),
                "byteLength": rows.nbytes,
                "extensions": {name: packed},
            }
        )
    maker.parts["bufferViews"] = views
    place = maker.described(SQUARE.shape, "f4", bufferView=0)
    indices = maker.described((6, 1), "u2", bufferView=1)
    primitive = {"attributes": {"POSITION": place}, "indices": indices}
    maker.shown({"mesh": maker.mesh(primitive)})
    own = {"byteLength": len(maker.data)}
    maker.parts["buffers"] = [own, fallback or {"byteLength": 60, "extensions": {name: {}}}]
    maker.parts["extensionsUsed"] = [name]
    if fallback is None:
        maker.parts["extensionsRequired"] = [name]
    return maker


def compressed_by_draco():
    """A square whose only data Draco compresses."""
    maker = GltfMaker()
    data = draco.encode(SQUARE, FACES.astype(np.uint32), preserve_order=True)
    view = maker.view(data)
    place = maker.described(SQUARE.shape, "f4", min=[0, 0, 0], max=[0.99, 1, 0])
    indices = maker.described((6, 1), "u2")
    primitive = {
        "attributes": {"POSITION": place},
        "indices": indices,
        "extensions": {DRACO: {"bufferView": view, "attributes": {"POSITION": 0}}},
    }
    maker.shown({"mesh": maker.mesh(primitive)})
    maker.parts["extensionsUsed"] = maker.parts["extensionsRequired"] = [DRACO]
    return maker


def shape_of(maker, folder):
    """The corners of the triangles in the file, (F, 3, 3)."""
    mesh = assets.read_mesh(maker.write(folder / "a.glb"))
    return mesh.vertices[mesh.faces]


@pytest.mark.parametrize("name", MESHOPT)
def test_meshopt_is_decompressed(tmp_path, name):
    """Places and triangles are those of the file without compression, under both names."""
    assert np.array_equal(shape_of(compressed_by_meshopt(name), tmp_path), SQUARE[FACES])


def test_draco_is_decompressed(tmp_path):
    """Places and triangles are those of the file without compression."""
    found = np.sort(shape_of(compressed_by_draco(), tmp_path).reshape(2, -1), axis=0)
    assert np.allclose(found, np.sort(SQUARE[FACES].reshape(2, -1), axis=0), atol=1e-3)


def test_uncompressed_data_are_preferred(tmp_path):
    """A file with both needs no decompression: here its uncompressed square is twice as large."""
    plain = (2.0 * SQUARE).tobytes() + FACES.tobytes()
    (tmp_path / "plain.bin").write_bytes(plain)
    maker = compressed_by_meshopt(fallback={"byteLength": len(plain), "uri": "plain.bin"})
    assert np.array_equal(shape_of(maker, tmp_path), 2.0 * SQUARE[FACES])


@pytest.mark.parametrize("make", [compressed_by_meshopt, compressed_by_draco])
def test_a_copy_is_not_compressed(make, tmp_path):
    """An avatar starts from a document without compression, whose bounds are true."""
    document, data = read_document(make().glb(), tmp_path)
    assert "compression" not in json.dumps(document)
    accessor = document["accessors"][0]
    view = document["bufferViews"][accessor["bufferView"]]
    places = np.frombuffer(data, np.float32, 12, view["byteOffset"]).reshape(-1, 3)
    assert np.allclose(np.sort(places, axis=0), np.sort(SQUARE, axis=0), atol=1e-3)
    if "max" in accessor:
        assert np.array_equal(accessor["max"], places.max(axis=0))


@pytest.mark.parametrize(
    ("make", "package"), [(compressed_by_meshopt, "meshopt"), (compressed_by_draco, "DracoPy")]
)
def test_a_missing_package_is_named(make, package, tmp_path, monkeypatch):
    """One line names the package, the extra and the other remedy."""
    maker = make()
    monkeypatch.setitem(sys.modules, package, None)
    remedy = rf"needs {package}; install it .*'\.\[compression\]', or export it without compression"
    with pytest.raises(AssetError, match=remedy) as refusal:
        shape_of(maker, tmp_path)
    assert "\n" not in str(refusal.value)


def _broken(maker):
    maker.data[:] = b"\x55" * len(maker.data)


def _endless(maker):
    packed = maker.parts["bufferViews"][0]["extensions"][MESHOPT[0]]
    packed["count"] = 10**9


@pytest.mark.parametrize(
    ("make", "change", "message"),
    [
        (compressed_by_meshopt, _broken, "broken, or named as another format"),
        (compressed_by_draco, _broken, "broken, or named as another format"),
        (compressed_by_meshopt, _endless, "more than 400 MB of data that are compressed"),
    ],
)
def test_broken_data_give_one_line(make, change, message, tmp_path):
    """Data that cannot be decompressed, or would not fit in memory, give one clear line."""
    maker = make()
    change(maker)
    with pytest.raises(AssetError, match=message) as refusal:
        shape_of(maker, tmp_path)
    assert "\n" not in str(refusal.value)


KTX2 = {  # a square of 8 pixels, (200, 40, 30) above (30, 60, 200), by both codecs
    "ETC1S": (
        "eNpb7R0SoWBksJuXS4qLAQgYgZgDimGAEQlnALEOEE8BYhUg3gFV0w2lnRkhNBMDKtBhgIlrMCxmZGJgZka2wx"
        "7O+g8E8kAa6KzyosyS1CIGp8TizGKF0LzMstSi4sQcBSM9QwOQOUwMekB1nEhmMzBg2i1/YAqEsclpKuMZCNNx"
        "D78hgzDEoR4MLAlcDWDmyUNaLEBqxapVq5hMDrhA1Aq5MsxgEACxHGQY1VhATm5QKPJiPMACtYuDYQEjAPRjJl"
        "Q="
    ),
    "UASTC": (
        "eNpb7R0SoWBksJuXS4qLAQgYgZgDimGAEYpBIAOIdYB4CpRGBwegtAMaDVPLxKDBsIyRiYGZmYFBAK6rHs76Dw"
        "TyQBrorPKizJLUIganxOLMYoXQvMyy1KLixBwFIz1DAwYGFpAuoDZxyaOP6y8ch+tH519vZv9Zr6TBjIsPAKSu"
        "JNs="
    ),
}


def picture_of(content, folder):
    """The picture of a square whose KTX 2 file has this content."""
    maker = GltfMaker()
    image = maker.add("images", {"bufferView": maker.view(content), "mimeType": "image/ktx2"})
    texture = maker.add("textures", {"extensions": {"KHR_texture_basisu": {"source": image}}})
    paint = {"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}}
    uv = {"TEXCOORD_0": maker.accessor(SQUARE[:, :2])}
    material = maker.add("materials", paint)
    primitive = maker.primitive(SQUARE, FACES, attributes=uv, material=material)
    maker.shown({"mesh": maker.mesh(primitive)})
    maker.parts["extensionsRequired"] = maker.parts["extensionsUsed"] = ["KHR_texture_basisu"]
    return assets.read_mesh(maker.write(folder / "a.glb")).texture.pictures[0]()


@pytest.mark.parametrize("codec", KTX2)
def test_pictures_in_ktx2_are_read(codec, tmp_path):
    """KHR_texture_basisu: rows run from the top, and colours are right to a few levels."""
    pytest.importorskip("opengl_basisu", reason="needs the extra 'compression'")
    picture = picture_of(unzipped(KTX2[codec]), tmp_path)
    assert picture.shape == (8, 8, 3)
    assert np.abs(picture[0, 0].astype(int) - (200, 40, 30)).max() < 6
    assert np.abs(picture[7, 7].astype(int) - (30, 60, 200)).max() < 6


@pytest.mark.parametrize("codec", KTX2)
def test_broken_pictures_in_ktx2_are_named(codec, tmp_path):
    """A cut file gives one line; a missing package is named with the extra."""
    pytest.importorskip("opengl_basisu", reason="needs the extra 'compression'")
    with pytest.raises(AssetError, match="its picture 0: is broken, or no Basis Universal"):
        picture_of(unzipped(KTX2[codec])[:100], tmp_path)


def test_ktx2_names_its_missing_package(tmp_path, monkeypatch):
    """Without the package, one line names it, the extra and another remedy."""
    monkeypatch.setitem(sys.modules, "opengl_basisu", None)
    remedy = r"needs opengl_basisu; install it .*'\.\[compression\]', or save it as PNG"
    with pytest.raises(AssetError, match=remedy):
        picture_of(unzipped(KTX2["UASTC"]), tmp_path)


def unzipped(text):
    """The bytes of a text in base64."""
    return zlib.decompress(base64.b64decode(text))
