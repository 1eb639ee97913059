"""Material libraries of OBJ files, as programs write them, and pictures of every kind."""

import io
import struct
import unicodedata
import zlib

import numpy as np
import PIL.Image
import pytest

from risorius import assets
from risorius.assets import AssetError
from risorius.assets.painted import read_painted
from risorius.assets.pictures import decoded
from risorius.assets.wavefront import maps_of
from tests.assets.gltf_square import RED, png

OBJ = (
    "mtllib {library}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt .25 .5\nvt .75 .5\nvt .75 1\n"
    "usemtl {material}\nf 1/1 2/2 3/3\n"
)
UV = np.array([[0.25, 0.5], [0.75, 0.5], [0.75, 1.0]])


def read(folder, material, library, /, **names):
    """A triangle with one material of a library.

    names: file or material names for the keys "material", "library" and "picture".
    """
    path = folder / "a.obj"
    named = names.get("library", "a.mtl")
    path.write_text(OBJ.format(library=named, material=names.get("material", material)))
    (folder / names.get("file", named)).write_bytes(library.encode())
    picture = folder / names.get("picture", "skin.png")
    picture.parent.mkdir(exist_ok=True)
    picture.write_bytes(png())
    return assets.read_mesh(path)


def colour_of(mesh):
    """The colour of a mesh's picture."""
    assert mesh.texture.picture.tolist() == [0]
    red, green, blue = mesh.texture.pictures[0]()[0, 0].tolist()
    return red, green, blue


@pytest.mark.parametrize(
    ("library", "picture"),
    [
        ("newmtl skin\n\tKd 0.2 0.5 0.9\n\tmap_Kd\tskin.png\n", "skin.png"),
        ("newmtl\tskin  \r\n  map_Kd   skin.png \t\r\n", "skin.png"),
        ("newmtl skin\rmap_Kd skin.png\r", "skin.png"),
        ("# C:\\maps\\\nnewmtl skin\nmap_Kd \\\n  skin.png", "skin.png"),
        ("newmtl skin\nmap_Kd \\ \t\n  skin.png", "skin.png"),
        ("newmtl skin\nmap_kd skin.png", "skin.png"),
        ('newmtl skin\nmap_Kd "skin of  anna.png"\n', "skin of  anna.png"),
        ("newmtl skin\nmap_Kd skin of  anna #2.png\n", "skin of  anna #2.png"),
        ("newmtl skin\nmap_Kd maps\\skin.png\n", "maps/skin.png"),
        ("newmtl skin\nmap_Kd ./maps/skin.png\n", "maps/skin.png"),
        ("newmtl skin\nmap_Kd -blendu on -mm 0 1 -bm 1.0 -clamp off my skin.png", "my skin.png"),
        ('newmtl skin\nmap_Kd\t-s 1 1 1 -o 0 0 0\t"2 skins.png"', "2 skins.png"),
        ("newmtl skin\nmap_Kd -o 0 0 -imfchan m 2.png", "2.png"),
    ],
)
def test_libraries_are_read_as_programs_write_them(tmp_path, library, picture):
    """Tabs, blanks, line ends, quoted names, names with blanks, folders and options are read."""
    mesh = read(tmp_path, "skin", library, picture=picture)
    assert colour_of(mesh) == RED
    assert np.allclose(mesh.texture.uv[mesh.texture.face_uv], [UV])


@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        ("-s 2 3 1", UV * [2, 3]),
        ("-s 2", UV * [2, 1]),
        ("-o 0.25 -0.5 0", UV + np.array([0.25, -0.5])),
        ("-s 4 4 -o -.5", UV * 4 + np.array([-0.5, 0])),
        ("-clamp on -s 2 2 2", (UV * 2).clip(0, 1)),
    ],
)
def test_options_scale_and_shift_a_picture(tmp_path, options, wanted):
    """A picture's coordinates are scaled first, and shifted then."""
    mesh = read(tmp_path, "skin", f"newmtl skin\nmap_Kd {options} skin.png\n")
    assert colour_of(mesh) == RED
    assert np.allclose(mesh.texture.uv[mesh.texture.face_uv], [wanted])


@pytest.mark.parametrize(
    ("line", "file"),
    [
        ("my head.mtl", "my head.mtl"),
        ("lost.mtl a.mtl", "a.mtl"),
        ("a.mtl  # by hand", "a.mtl"),
        ("a.mtl \t", "a.mtl"),
        ("maps\\..\\a.mtl", "a.mtl"),
    ],
)
def test_lines_name_libraries(tmp_path, line, file):
    """A library line may have several names, a name with blanks, and a comment."""
    (tmp_path / "maps").mkdir()
    mesh = read(tmp_path, "skin", "newmtl skin\nmap_Kd skin.png\n", library=line, file=file)
    assert colour_of(mesh) == RED


@pytest.mark.parametrize("name", ["Material__25", "Material #25", "01 -  Default#1", "my\tskin"])
def test_materials_may_have_any_names(tmp_path, name):
    """Material names may have blanks and number signs; a comment may follow in the OBJ file."""
    library = f"newmtl Material\nmap_Kd other.png\nnewmtl {name}\nmap_Kd skin.png\n"
    assert colour_of(read(tmp_path, name, library)) == RED
    assert colour_of(read(tmp_path, name, library, material=f"{name} # of the face")) == RED


@pytest.mark.parametrize(
    ("name", "encoding"),
    [
        ("Gesichtshaut für Jürgen", "utf-8"),
        ("Gesichtshaut für Jürgen", "latin-1"),
        ("Gesichtshaut für Jürgen", "utf-16"),
        ("顔　の 肌", "utf-8"),
        ("顔　の 肌", "utf-16"),
        ("кожа", "utf-8"),
    ],
)
def test_names_may_have_any_letters(tmp_path, name, encoding):
    """Names of library, material, group and picture may have any letters.

    UTF-8 and UTF-16 are recognised; any other file is read as Latin-1.
    """
    obj = OBJ.format(library=f"{name}.mtl", material=name).replace("\nf", f"\ng {name}\nf")
    (tmp_path / f"{name}.obj").write_bytes(obj.encode(encoding))
    library = f"# {name}\nnewmtl {name}\nmap_Kd -s 1 1 1 maps\\{name}.png\n"
    (tmp_path / f"{name}.mtl").write_bytes(library.encode(encoding))
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / f"{name}.png").write_bytes(png())
    assert colour_of(assets.read_mesh(tmp_path / f"{name}.obj")) == RED
    painted = read_painted(tmp_path / f"{name}.obj")
    assert painted.parts == (name,)
    (material,) = painted.materials
    assert (material.name, material.picture) == (name, (png(), f"{name}.png"))


def test_letters_with_marks_may_be_written_in_two_ways(tmp_path):
    """A picture is found if its name and the library differ in the form of accented letters.

    A copied file may have letter and accent separate, where the library has one character.
    """
    library = "newmtl skin\nmap_Kd für.png\n"
    apart = unicodedata.normalize("NFD", "für.png")
    assert apart != "für.png"
    assert colour_of(read(tmp_path, "skin", library, picture=apart)) == RED


def test_a_wrong_line_may_have_any_letters(tmp_path):
    """A wrong line is shown as one line, even if it is cut within a letter."""
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nf 1 2 " + "ü" * 40, encoding="utf-8")
    with pytest.raises(AssetError, match="line 2: 'f 1 2 ü"):
        assets.read_mesh(path)


def test_libraries_name_pictures_of_all_kinds():
    """Maps of colour, of bumps with options, and of gloss are recognised."""
    library = b"newmtl a\nmap_Kd a.png\nbump -bm 0.4 b c.png\nmap_Ks maps\\d.png\nKs 1 1 1\n"
    assert maps_of(library) == ["a.png", "b c.png", "maps\\d.png"]


def test_pictures_may_lie_otherwise_each(tmp_path):
    """Two materials may share one picture with separate shifts; a triangle may have none."""
    path = tmp_path / "a.obj"
    obj = OBJ.format(library="a.mtl", material="b") + "usemtl a\nf 1/1 2/2 3/3\nf 1 2 3\n"
    path.write_text(obj)
    (tmp_path / "skin.png").write_bytes(png())
    library = "newmtl a\nmap_Kd -o 0.5 0 skin.png\nnewmtl b\nmap_Kd skin.png\n"
    (tmp_path / "a.mtl").write_text(library)
    texture = assets.read_mesh(path).texture
    assert texture.picture[2] == -1
    assert np.allclose(texture.uv[texture.face_uv][:2], [UV, UV + np.array([0.5, 0])])


def _saved(image, form):
    content = io.BytesIO()
    image.save(content, form)
    return content.getvalue()


def _grey(levels):
    return PIL.Image.fromarray(levels.astype(np.uint16))


def _palette():
    image = PIL.Image.new("P", (4, 4), 1)
    image.putpalette([0, 0, 0, *RED])
    image.info["transparency"] = 1
    return image


@pytest.mark.parametrize(
    ("content", "wanted"),
    [
        (_saved(_grey(np.full((4, 4), 0x8080)), "PNG"), (128, 128, 128)),
        (_saved(_grey(np.full((4, 4), 300)), "PNG"), (1, 1, 1)),
        (_saved(PIL.Image.new("L", (4, 4), 77), "PNG"), (77, 77, 77)),
        (_saved(PIL.Image.new("LA", (4, 4), (77, 3)), "PNG"), (77, 77, 77)),
        (_saved(PIL.Image.new("1", (4, 4), 1), "PNG"), (255, 255, 255)),
        (_saved(_palette(), "PNG"), RED),
        (_saved(PIL.Image.new("RGBA", (4, 4), (*RED, 0)), "PNG"), RED),
        (_saved(PIL.Image.new("CMYK", (16, 16), (0, 255, 255, 0)), "JPEG"), (255, 0, 0)),
        (_saved(PIL.Image.new("L", (16, 16), 77), "JPEG"), (77, 77, 77)),
        (_saved(PIL.Image.new("RGB", (16, 16), (77, 77, 77)), "WEBP"), (77, 77, 77)),
    ],
)
def test_pictures_of_every_kind_keep_their_colours(content, wanted):
    """Pictures in 16-bit grey, with palettes, in CMYK, and with transparency are read."""
    found = decoded(content, "skin")
    assert found.dtype == np.uint8
    assert found.shape[2] == 3
    assert np.abs(found[1, 1].astype(int) - wanted).max() <= 3


def test_colours_of_16_bits_keep_their_higher_bits():
    """PNG files with 16 bits per channel are read, and the higher 8 bits are kept."""

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    row = b"\0" + struct.pack(">3H", 0xFA12, 0x0A99, 0x14FF) * 2
    content = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 2, 16, 2, 0, 0, 0))
    content += chunk(b"IDAT", zlib.compress(row * 2)) + chunk(b"IEND", b"")
    assert decoded(content, "skin")[1, 1].tolist() == list(RED)


def test_other_formats_are_named():
    """An unknown format is refused in one line with the accepted formats."""
    content = _saved(PIL.Image.new("RGB", (4, 4)), "BMP")
    with pytest.raises(AssetError, match=r"its picture skin\.bmp: .* neither PNG, JPEG nor WebP"):
        decoded(content, "skin.bmp")
