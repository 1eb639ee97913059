"""Odd and broken OBJ files."""

from __future__ import annotations

from .head_inputs import OddHead, mesh_file

V = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
TRIANGLE = f"{V}f 1 2 3\n"
BOX = "".join(f"v {i & 1} {i >> 1 & 1} {i >> 2}\n" for i in range(8))
MANY = 510_000

GOOD = {
    "plain": TRIANGLE,
    "latin-1 names": TRIANGLE.encode().replace(b"f 1", b"o t\xeate\ng visage\xa0g\nf 1"),
    "utf-8 mark": b"\xef\xbb\xbf" + TRIANGLE.encode(),
    "utf-16 le": TRIANGLE.encode("utf-16"),
    "crlf": TRIANGLE.replace("\n", "\r\n"),
    "continued": "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 \\\n3\n",
    "remark with backslash": "# C:\\heads\\\n" + TRIANGLE,
    "relative": f"{BOX}f -8/-13/-6 -7/-2/-3 -6/-1/-1\n",
    "texture": f"{V}vt 0 0\nf 1/1 2/1 3/1\n",
    "broken texture numbers": f"{V}f 1/99/99 2/-99/7 3/x/y\n",
    "weight": TRIANGLE.replace("0\nv", "0 1.0\nv"),
    "mixed polygons": f"{BOX}f 1 2 3\nf 1 2 3 4\nf 1 2 3 4 5 6 7 8\n",
    "big polygon": V + "f" + " 1 2 3" * 10_000 + "\n",
    "two materials": f"mtllib a.mtl\n{V}usemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n",
    "curves and lines": f"{TRIANGLE}l 1 2\np 1\nvp 0 0\ncurv 0 1 1 2\nend\n",
    "unknown words": f"hello world\n{TRIANGLE}\x00".replace("\x00", "") + "call a.obj\ncsh rm\n",
    "vertices of no face": "v 9 9 9\n" * 50 + V + "f -1 -2 -3\n",
    "thousand objects": "".join(f"o part{n}\n{V}f -3 -2 -1\n" for n in range(1000)),
}

BAD = {
    "material is a device": (
        f"mtllib /dev/zero\n{V}usemtl a\nf 1 2 3\n",
        "it must lie in the mesh's folder",
    ),
    "empty": ("", "is empty; it must be a mesh file"),
    "blank": ("\n\n \n", "holds no triangles"),
    "only faces": ("f 1 2 3\n", r"triangle 0 .* has the vertices \[0, 1, 2\]"),
    "utf-16 without mark": (TRIANGLE.encode("utf-16-le"), "binary data .* as text UTF-8"),
    "picture": (b"\x89PNG\r\n\x1a\n" + bytes(64), "binary data"),
    "cut in a face": (f"{V}f 1 2", "line 4: a face has 2 corners; it must have at least 3"),
    "flat": ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "line 1: a vertex has 2 coordinates"),
    "comma": (TRIANGLE.replace("1 0 0", "1,5 0 0"), r"line 2: 'v 1,5 0 0' is no vertex"),
    "word for a corner": (f"{V}f 1 2 drei\n", "line 4: 'f 1 2 drei' is no face"),
    "slash alone": (f"{V}f / / /\n", "is no face"),
    "nan": (
        TRIANGLE.replace("1 0 0", "nan 0 0"),
        r"vertex 1 .* at \[nan, 0.0, 0.0\]; it must",
    ),
    "too far": (TRIANGLE.replace("1 0 0", "1e300 0 0"), r"vertex 1 .* at \[1e\+300"),
    "long number": (TRIANGLE.replace("1 0 0", "9" * 5000 + " 0 0"), "must be finite numbers"),
    "corner zero": (f"{V}f 0 1 2\n", "line 4: no vertex has the number 0; allowed are 1 to"),
    "corner beyond": (f"{V}f 1 2 4\n", r"has the vertices \[0, 1, 3\]; there are 0 to 2"),
    "corner far beyond": (f"{V}f 1 2 {10**30}\n", "line 4: no vertex has the number 1000"),
    "corner before": (f"{V}f -4 1 2\n", "number -4; allowed are .* -1 to -3 at this line"),
    "relative before its line": (f"f -1 -2 -3\n{V}", "line 1: no vertex has the number -1"),
    "long line": (V + "f" + " 1" * 600_000, "has 1200001 bytes in line 4; allowed are 1048576"),
    "many lines": (b"#\n" * 2_100_000, "has 2100000 lines; allowed are 2000000"),
    "many vertices": (b"v 0 0 0\n" * MANY, "line 500001: more than 500000 vertices or"),
    "many triangles": (
        V.encode() + (b"f" + b" 1 2 3" * 100_000 + b"\n") * 4,
        "line 5: more than 500000 vertices or triangles",
    ),
    "gzip": (b"\x1f\x8b\x08\x00" + bytes(40), r"is packed \(gzip\); unpack it"),
}

INPUTS: tuple[OddHead, ...] = (
    *(mesh_file(f"{name}.obj", content) for name, content in GOOD.items()),
    *(mesh_file(f"bad/{name}.obj", content, says) for name, (content, says) in BAD.items()),
)
