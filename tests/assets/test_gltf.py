"""glTF is read as specified: all numeric types, transforms, pictures and colours."""

import numpy as np
import pytest

from tests.assets.gltf_square import (
    FACES,
    GREEN,
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


@pytest.mark.parametrize(("kind", "greatest"), [("f4", 1), ("u1", 255), ("u2", 65535)])
def test_texture_coordinates_may_be_normalized_integers(maker, tmp_path, kind, greatest):
    """Normalized bytes and shorts are fractions of the type's maximum."""
    rows = np.rint(UV * greatest) if greatest > 1 else UV
    painted(maker, maker.accessor(rows, kind, normalized=greatest > 1, gap=2))
    found = read(maker, tmp_path)
    assert np.abs(uv_of(found) - UP_UV[FACES]).max() < 0.6 / greatest + 1e-6


def test_a_picture_may_have_the_second_coordinates(maker, tmp_path):
    """The material gives the number of the set of texture coordinates, which may be any."""
    first = maker.accessor(np.zeros((4, 2)))
    third = maker.accessor(UV)
    painted(maker, first, {"texCoord": 2}, TEXCOORD_1=first, TEXCOORD_2=third)
    assert np.allclose(uv_of(read(maker, tmp_path)), UP_UV[FACES])


@pytest.mark.parametrize(
    ("placing", "wanted"),
    [
        ({"offset": [0.25, 0.5]}, UV + np.array([0.25, 0.5])),
        ({"scale": [0.5, 2.0], "offset": [0.25, 0.0]}, UV * [0.5, 2.0] + [0.25, 0.0]),
        # Rotation is counter-clockwise with v downward, so u becomes -v.
        ({"rotation": np.pi / 2}, np.column_stack([UV[:, 1], -UV[:, 0]])),
        ({"rotation": np.pi / 2, "scale": [2.0, 1.0]}, np.column_stack([UV[:, 1], -2 * UV[:, 0]])),
        ({"texCoord": 1}, UV[::-1]),
    ],
)
def test_texture_coordinates_are_transformed(maker, tmp_path, placing, wanted):
    """KHR_texture_transform scales, rotates and shifts coordinates, and may name another set."""
    maker.parts["extensionsRequired"] = ["KHR_texture_transform"]
    info = {"extensions": {"KHR_texture_transform": placing}}
    painted(maker, maker.accessor(UV), info, TEXCOORD_1=maker.accessor(UV[::-1]))
    found = uv_of(read(maker, tmp_path))
    assert np.allclose(found, (wanted * [1, -1] + [0, 1])[FACES], atol=1e-6)


def test_pictures_go_on_beyond_their_edge_as_the_file_says(maker, tmp_path):
    """A sampler that clamps along u and mirrors along v is followed beyond the edge."""
    sampler = maker.add("samplers", {"wrapS": 33071, "wrapT": 33648})
    texture = maker.picture(png(), sampler=sampler)
    uv = maker.accessor(np.array([[-0.5, 1.25], [1.75, 1.25], [1.75, -0.25], [0.5, -0.25]]))
    number = material(maker, {"index": texture})
    show_square(maker, {"TEXCOORD_0": uv}, material=number)
    wanted = np.array([[0.0, 0.25], [1.0, 0.25], [1.0, 0.75], [0.5, 0.75]])
    assert np.allclose(uv_of(read(maker, tmp_path)), wanted[FACES])


@pytest.mark.parametrize(
    ("kind", "normalized", "scale"),
    [("i1", True, 127), ("i2", True, 32767), ("u2", False, 1), ("i2", False, 1), ("u1", False, 1)],
)
def test_positions_may_be_integers(maker, tmp_path, kind, normalized, scale):
    """KHR_mesh_quantization is read: a node scales integers; rows are padded to four bytes."""
    maker.parts["extensionsRequired"] = ["KHR_mesh_quantization"]
    width = int(kind[1])
    rows = maker.accessor(SQUARE * 100, kind, gap=-3 * width % 4, normalized=normalized)
    square = {"attributes": {"POSITION": rows}, "indices": maker.accessor(FACES.ravel(), "u1")}
    maker.shown({"mesh": maker.mesh(square), "scale": [scale / 100] * 3, "translation": [5, 0, 0]})
    assert np.allclose(shape_of(read(maker, tmp_path)), (SQUARE + np.array([5, 0, 0]))[FACES])


@pytest.mark.parametrize("width", [3, 4])
@pytest.mark.parametrize(("kind", "greatest"), [("f4", 1), ("u1", 255), ("u2", 65535)])
def test_colours_of_vertices_are_linear_light(maker, tmp_path, kind, greatest, width):
    """Linear vertex colours 0.2 0.5 0.9 become 124 188 243 on a screen, for any numeric type."""
    rows = np.tile(np.array([0.2, 0.5, 0.9, 0.3])[:width] * greatest, (4, 1))
    rows = rows if greatest == 1 else np.rint(rows)
    colours = maker.accessor(rows, kind, normalized=greatest > 1, gap=-width * int(kind[1]) % 4)
    show_square(maker, {"COLOR_0": colours})
    found = read(maker, tmp_path).colours
    assert np.abs(found.astype(int) - (124, 188, 243)).max() <= 1


def test_materials_tint(maker, tmp_path):
    """A material's linear factors multiply colours and pictures; without them nothing changes."""
    texture = maker.picture(png((200, 200, 200)))
    half = material(maker, {"index": texture}, baseColorFactor=[0.5, 1.0, 0.0, 1.0])
    plain = material(maker, {"index": texture})
    attributes = {"TEXCOORD_0": maker.accessor(UV), "COLOR_0": maker.accessor(np.ones((4, 3)))}
    squares = [
        maker.primitive(SQUARE + shift, FACES, attributes=attributes, material=number)
        for shift, number in ((0, half), (5, plain))
    ]
    maker.shown({"mesh": maker.mesh(*squares)})
    found = read(maker, tmp_path)
    assert found.texture.picture.tolist() == [0, 0, 1, 1]
    tinted, whole = (picture() for picture in found.texture.pictures)
    assert np.abs(tinted[0, 0].astype(int) - (147, 200, 0)).max() <= 1
    assert whole[0, 0].tolist() == [200, 200, 200]
    assert found.colours[0].tolist() == [188, 255, 0]
    assert found.colours[4].tolist() == [255] * 3


def test_older_materials_have_a_picture(maker, tmp_path):
    """The picture that KHR_materials_pbrSpecularGlossiness names diffuse is read."""
    info = {"diffuseTexture": {"index": maker.picture(png(GREEN)), "texCoord": 1}}
    number = maker.add("materials", {"extensions": {"KHR_materials_pbrSpecularGlossiness": info}})
    show_square(maker, {"TEXCOORD_1": maker.accessor(UV)}, material=number)
    found = read(maker, tmp_path)
    assert np.allclose(uv_of(found), UP_UV[FACES])
    assert found.texture.pictures[0]()[0, 0].tolist() == list(GREEN)


def test_webp_and_transparent_pictures_are_read(maker, tmp_path):
    """A picture that only EXT_texture_webp names is read; transparency is ignored."""
    image = maker.add("images", {"bufferView": maker.view(png((*RED, 9), "WEBP"))})
    texture = maker.add("textures", {"extensions": {"EXT_texture_webp": {"source": image}}})
    number = material(maker, {"index": texture})
    show_square(maker, {"TEXCOORD_0": maker.accessor(UV)}, material=number)
    found = read(maker, tmp_path)
    assert found.texture.pictures[0]().shape == (4, 4, 3)


def test_nodes_place_meshes(maker, tmp_path):
    """Nodes rotate, scale, shift, nest, and have matrices; a mirroring node keeps the outside."""
    half = np.sqrt(0.5)
    square = maker.mesh(maker.primitive(SQUARE, FACES))
    matrix = np.array([[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 7], [0, 0, 0, 1.0]])
    child = maker.add("nodes", {"mesh": square, "matrix": matrix.T.ravel().tolist()})
    maker.add("nodes", {"mesh": square})  # a node in no scene
    turned = {"rotation": [0, 0, half, half], "scale": [2, 2, 2], "translation": [0, 0, 1]}
    maker.shown({"children": [child], **turned}, {"mesh": square})
    found = read(maker, tmp_path)
    mirrored = np.column_stack([-2 * SQUARE[:, 1], -2 * SQUARE[:, 0], SQUARE[:, 2] + 15])
    assert np.allclose(shape_of(found)[:2], SQUARE[FACES])
    assert np.allclose(shape_of(found)[2:], mirrored[FACES[:, ::-1]])


@pytest.mark.parametrize(
    ("mode", "corners", "wanted"),
    [
        (None, [0, 1, 2, 0, 2, 3], FACES),
        (5, [1, 2, 0, 3], [[1, 2, 0], [0, 2, 3]]),
        (5, [0, 0, 1, 2, 2, 3, 3], [[1, 0, 2]]),
        (6, [0, 1, 2, 3], FACES),
    ],
)
def test_triangles_may_be_strips_and_fans(maker, tmp_path, mode, corners, wanted):
    """Strips and fans with any index type are read; lines and points are left out."""
    square = maker.primitive(SQUARE, None, **({} if mode is None else {"mode": mode}))
    square["indices"] = maker.accessor(corners, "u2")
    line = maker.primitive(SQUARE, [0, 1, 2, 3], mode=1)
    maker.shown({"mesh": maker.mesh(line, square)})
    assert read(maker, tmp_path).faces.tolist() == np.asarray(wanted).tolist()


def test_triangles_need_no_indices(maker, tmp_path):
    """Without indices, three vertices form a triangle; vertices at one place are merged."""
    maker.shown({"mesh": maker.mesh(maker.primitive(SQUARE[FACES].reshape(-1, 3), None))})
    assert read(maker, tmp_path).faces.tolist() == [[0, 1, 2], [0, 2, 5]]


@pytest.mark.parametrize("has_rows", [True, False])
def test_sparse_rows_are_filled_in(maker, tmp_path, has_rows):
    """Sparse accessors replace some rows, or rows of zeros without a buffer view."""
    filled = (
        SQUARE + np.array([0, 0, 3]) if has_rows else np.where([[0], [1], [0], [1]], SQUARE, 0.0)
    )
    sparse = {
        "count": 2,
        "indices": {"bufferView": maker.view(bytes([1, 3])), "componentType": 5121},
        "values": {"bufferView": maker.view(filled[[1, 3]].astype("<f4").tobytes())},
    }
    plain = (SQUARE + np.array([0, 0, 3])) * [[1], [9], [1], [9]]
    more = {"bufferView": maker.view(plain.astype("<f4").tobytes())} if has_rows else {}
    rows = maker.described((4, 3), "f4", sparse=sparse, **more)
    square = {"attributes": {"POSITION": rows}, "indices": maker.accessor([0, 1, 3], "u1")}
    maker.shown({"mesh": maker.mesh(square)})
    assert np.allclose(shape_of(read(maker, tmp_path)), filled[[[0, 1, 3]]])


def halves(shift=0.0):
    """The square as two triangles with separate vertices."""
    return SQUARE[[0, 1, 2]], SQUARE[[0, 2, 3]] + [0, 0, shift]


@pytest.mark.parametrize("is_one_mesh", [True, False])
def test_parts_of_a_mesh_hang_together(maker, tmp_path, is_one_mesh):
    """Parts of one mesh are joined at equal vertices; lashes in another mesh are not."""
    parts = [maker.primitive(half, [0, 1, 2]) for half in halves()]
    meshes = [maker.mesh(*parts)] if is_one_mesh else [maker.mesh(part) for part in parts]
    maker.shown(*({"mesh": number} for number in meshes))
    found = read(maker, tmp_path)
    assert len(found.vertices) == 6
    assert len(np.unique(found.faces)) == (4 if is_one_mesh else 6)


@pytest.mark.parametrize("moved", ["shape", "bone", "nothing"])
def test_vertices_that_move_apart_are_two(maker, tmp_path, moved):
    """Lip vertices at one place are kept separate if a shape or a bone of the file parts them."""
    first, second = halves()
    joints = np.zeros((3, 4))
    attributes = [{}, {}]
    if moved == "bone":
        weights = maker.accessor(np.tile([1.0, 0, 0, 0], (3, 1)))
        attributes = [
            {"JOINTS_0": maker.accessor(joints + bone, "u1"), "WEIGHTS_0": weights}
            for bone in (0, 1)
        ]
    still = np.zeros((3, 3))
    raised = np.tile([0, 0.1, 0], (3, 1))
    shapes = [still, raised if moved == "shape" else still]
    parts = [
        maker.primitive(
            half, [0, 1, 2], attributes=own, targets=[{"POSITION": maker.accessor(added)}]
        )
        for half, own, added in zip((first, second), attributes, shapes, strict=True)
    ]
    bones = [maker.add("nodes", {}), maker.add("nodes", {})]
    maker.add("skins", {"joints": bones})
    node = {"mesh": maker.mesh(*parts), **({"skin": 0} if moved == "bone" else {})}
    maker.shown(node)
    found = read(maker, tmp_path)
    assert len(np.unique(found.faces)) == (4 if moved == "nothing" else 6)
    assert found.corners is not None
    assert np.array_equal(found.same[found.corners], found.faces)


@pytest.mark.parametrize("where", ["mesh", "node"])
def test_shapes_are_added_as_the_file_weighs_them(maker, tmp_path, where):
    """Morph targets are added with the weights of the file."""
    target = {"POSITION": maker.accessor(np.tile([0.0, 0.0, 2.0], (4, 1)))}
    square = maker.primitive(SQUARE, FACES, targets=[target])
    weights = {"weights": [0.5]}
    number = maker.mesh(square, **(weights if where == "mesh" else {"weights": [0.0]}))
    maker.shown({"mesh": number, **(weights if where == "node" else {})})
    assert np.allclose(shape_of(read(maker, tmp_path)), (SQUARE + np.array([0, 0, 1]))[FACES])


def test_bones_bend_meshes(maker, tmp_path):
    """Joints, not the node, place the vertices of a skinned mesh, also with many joints."""
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, :3, 3] = [-1, 0, 0]
    joints = np.array([[0, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0]])
    attributes = {
        "JOINTS_0": maker.accessor(joints, "u2"),
        "WEIGHTS_0": maker.accessor(np.tile([51, 0, 0, 0], (4, 1)), "u1", normalized=True),
        "JOINTS_1": maker.accessor(np.zeros((4, 4)), "u1"),
        "WEIGHTS_1": maker.accessor([[0] * 4] * 3 + [[0.2, 0, 0, 0]]),
    }
    square = maker.primitive(SQUARE, FACES, attributes=attributes)
    second = maker.add("nodes", {"translation": [1, 0, 5]})
    first = maker.add("nodes", {"translation": [0, 0, 3], "children": [second]})
    matrices = maker.accessor(bind.swapaxes(1, 2).reshape(2, 16))
    maker.add("skins", {"joints": [first, second], "inverseBindMatrices": matrices})
    node = maker.add("nodes", {"mesh": maker.mesh(square), "skin": 0, "scale": [9, 9, 9]})
    maker.add("scenes", {"nodes": [first, node]})
    wanted = SQUARE + np.array([[0, 0, 3], [0, 0, 8], [0, 0, 8], [0, 0, 3.0]])
    assert np.allclose(shape_of(read(maker, tmp_path)), wanted[FACES], atol=1e-6)
