"""Scripts that nobody should write, and good ones that look odd; what is told of each.

A row is a name, the file's bytes, and words of the message; no words: it is accepted.
"""

from __future__ import annotations

KEY = "[[pose]]\ntime = 1\njoy = 1\n"
DEEP = 20_000  # brackets
ODD = "\u202e"  # turns what follows around

ACCEPTED: dict[str, bytes] = {
    "a mark of byte order": b"\xef\xbb\xbf" + KEY.encode(),
    "line ends of Windows": KEY.replace("\n", "\r\n").encode(),
    "only comments above": f"# {'x' * 9000}\n{KEY}".encode(),
    "the smallest time": b"[[pose]]\ntime = 0\n[[pose]]\ntime = 5e-324\njoy = 1\n",
    "tiny value": b"[[pose]]\ntime = 1\njoy = 1e-320\n",
    "minus zero": b"[[pose]]\ntime = 1\njoy = -0.0\n",
    "a day": b"duration = 86400\n[[pose]]\ntime = 86400.0\njoy = 1\n",
    "negative in a track": b"[tracks]\njoy = [{time = 1, value = -1}]\n",
    "an empty name": b"[[pose]]\ntime = 1\nname = ''\n",
    "a name in all scripts": "[[pose]]\ntime = 1\nname = 'радость 喜び 😀'\n".encode(),
    "hexadecimal": b"[[pose]]\ntime = 0x1\njoy = 0b1\n",
    "underscores": b"[[pose]]\ntime = 1_0.0\n",
    "a track of lines": b"[tracks]\njoy = '''\n0 0\n 1\t0.5 hold \r\n\n2 -1e-320\n'''\n",
    "numbers of Python in lines": b"[tracks]\njoy = '1_0 +.5'\n",
    "a million lines": b"[tracks]\njoy = '''\n"
    + b"\n".join(b"%d.%02d 0" % divmod(n, 100) for n in range(1_000_000))
    + b"'''\n",
    "ten thousand keys": b"".join(b"[[pose]]\ntime = %d\njoy = 1\n" % n for n in range(10_000)),
}

REFUSED: dict[str, tuple[bytes, str]] = {
    # Files.
    "empty": (b"", "no [[pose]] and no [tracks]"),
    "zeros": (bytes(1000), "not valid TOML"),
    "noise": (bytes(range(256)) * 4, "cannot be read as a text file"),
    "too long": (b"#" * (2**25 + 1), "is longer than a script may be"),
    # TOML.
    "deep lists": (b"pose = " + b"[" * DEEP + b"]" * DEEP, "wrong.toml: "),
    "deep names": (b"a" + b".a" * 5000 + b" = 1\n", "key"),
    "a date": (b"[[pose]]\ntime = 2003-02-14\n", "must be a number"),
    # The top level.
    "key with line end": (b'"a\\nb" = 1\n' + KEY.encode(), "unknown key"),
    "title is a list": (b"title = ['x']\n" + KEY.encode(), "must be a text"),
    "a long title in a list": (b"title = ['" + b"x" * 9000 + b"']\n" + KEY.encode(), "title"),
    "scene with line end": (b'scene = "mo\\non"\n' + KEY.encode(), "scene"),
    "camera is no number": (b"camera = 'nan,nan'\n" + KEY.encode(), "camera 'nan,nan'"),
    "camera with line end": (b'camera = "\\n"\n' + KEY.encode(), "camera"),
    "duration has many digits": (b"duration = " + b"9" * 400 + KEY.encode(), "TOML"),
    "duration is a large whole": (b"duration = " + b"9" * 400 + b"\n" + KEY.encode(), "a num"),
    # Poses.
    "only time zero": (b"[[pose]]\ntime = 0\njoy = 1\n", "must be above 0"),
    "empty name of a control": (b"[[pose]]\ntime = 1\n'' = 1\n", "unknown name ''"),
    "name with line end": (b'[[pose]]\ntime = 1\n"jo\\ny" = 1\n', "unknown name"),
    "of the other scene": (b"scene = 'plane'\n" + KEY.encode(), "unknown name 'joy'"),
    "easing is a long list": (b"[[pose]]\ntime = 1\neasing = [" + b"1," * 9000 + b"]\n", "easing"),
    "label with line end after the end": (
        b'duration = 1\n[[pose]]\ntime = 2\nname = "x\\ny"\n', "comes after the duration"
    ),
    # Tracks.
    "an unknown track": (b"[tracks]\njoi = [{time = 1, value = 1}]\n", "unknown name 'joi'"),
    "an empty track with line end": (b'[tracks]\n"a\\nb" = []\n', "must be a list of"),
    "a line of many numbers": (b"[tracks]\njoy = '" + b"1 " * 9000 + b"'\n", "must be a time"),
    "a line with escape": (b'[tracks]\njoy = "1 \\u001b[2J"\n', "must be a time, a value"),
    "lines that fall": (b"[tracks]\njoy = '''1 1\n0 1'''\n", "key 2: time 0 s does not come"),
    "lines at one time": (b"[tracks]\njoy = '''" + b"0 0\n" * 10**6 + b"'''\n", "does not come"),
    "too much outside of quotes": (b"a = [" + b"1," * 9_000_000 + b"]", "outside of quotes"),
}  # fmt: skip
