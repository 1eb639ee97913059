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
    "blank": (b" \n\t\n", "no [[pose]] and no [tracks]"),
    "zeros": (bytes(1000), "not valid TOML"),
    "noise": (bytes(range(256)) * 4, "cannot be read as a text file"),
    "UTF-16": (KEY.encode("utf-16"), "cannot be read as a text file"),
    "UTF-16 without mark": (KEY.encode("utf-16-le"), "not valid TOML"),
    "UTF-32": (KEY.encode("utf-32"), "cannot be read as a text file"),
    "Latin": ("# Kähler\n".encode("latin-1"), "cannot be read as a text file"),
    "half a letter": (b"# \xe2\x82", "cannot be read as a text file"),
    "line ends of old Macs": (KEY.replace("\n", "\r").encode(), "not valid TOML"),
    "too long": (b"#" * (2**25 + 1), "is longer than a script may be"),
    "JSON": (b'{"pose": []}', "not valid TOML"),
    "a picture": (b"\x89PNG\r\n\x1a\n", "cannot be read as a text file"),
    # TOML.
    "no end of text": (b"title = 'x\n" + KEY.encode(), "not valid TOML"),
    "twice the same key": (b"[[pose]]\ntime = 1\ntime = 2\n", "not valid TOML"),
    "a table and a list": (b"pose = 1\n[[pose]]\ntime = 1\n", "not valid TOML"),
    "a control character": (b"title = 'a\x07b'\n" + KEY.encode(), "not valid TOML"),
    "a bad escape": (b'title = "\\q"\n' + KEY.encode(), "not valid TOML"),
    "half a surrogate": (b'title = "\\ud800"\n' + KEY.encode(), "not valid TOML"),
    "deep lists": (b"pose = " + b"[" * DEEP + b"]" * DEEP, "wrong.toml: "),
    "deep tables": (b"a = " + b"{a=" * DEEP + b"1" + b"}" * DEEP, "wrong.toml: "),
    "deep names": (b"a" + b".a" * 5000 + b" = 1\n", "key"),
    "a long number": (b"[[pose]]\ntime = " + b"9" * 5000 + b"\n", "not valid TOML"),
    "a date": (b"[[pose]]\ntime = 2003-02-14\n", "must be a number"),
    "a time of day": (b"[[pose]]\ntime = 12:30:00\n", "must be a number"),
    "a wrong date": (b"[[pose]]\ntime = 2003-02-31\n", "not valid TOML"),
    # The top level.
    "key with line end": (b'"a\\nb" = 1\n' + KEY.encode(), "unknown key"),
    "key with escape": (b'"\\u001b[2J" = 1\n' + KEY.encode(), "unknown key"),
    "key turned around": (f'"{ODD}x" = 1\n{KEY}'.encode(), "unknown key"),
    "a long key": (b'"' + b"x" * 9000 + b'" = 1\n' + KEY.encode(), "unknown key"),
    "title is a list": (b"title = ['x']\n" + KEY.encode(), "must be a text"),
    "a long title in a list": (b"title = ['" + b"x" * 9000 + b"']\n" + KEY.encode(), "title"),
    "scene with line end": (b'scene = "mo\\non"\n' + KEY.encode(), "scene"),
    "camera is no number": (b"camera = 'nan,nan'\n" + KEY.encode(), "camera 'nan,nan'"),
    "camera with line end": (b'camera = "\\n"\n' + KEY.encode(), "camera"),
    "camera is empty": (b"camera = ','\n" + KEY.encode(), "camera"),
    "duration has many digits": (b"duration = " + b"9" * 400 + KEY.encode(), "TOML"),
    "duration is a large whole": (b"duration = " + b"9" * 400 + b"\n" + KEY.encode(), "a num"),
    # Poses.
    "only time zero": (b"[[pose]]\ntime = 0\njoy = 1\n", "must be above 0"),
    "time is a long list": (b"[[pose]]\ntime = [" + b"1," * 9000 + b"]\n", "must be a number"),
    "value with line end": (b'[[pose]]\ntime = 1\njoy = """a\nb"""\n', "must be a number"),
    "empty name of a control": (b"[[pose]]\ntime = 1\n'' = 1\n", "unknown name ''"),
    "name with line end": (b'[[pose]]\ntime = 1\n"jo\\ny" = 1\n', "unknown name"),
    "name with escape": (b'[[pose]]\ntime = 1\n"\\u001b[2J" = 1\n', "unknown name"),
    "a long name": (b"[[pose]]\ntime = 1\n" + b"x" * 9000 + b" = 1\n", "unknown name"),
    "of the other scene": (b"scene = 'plane'\n" + KEY.encode(), "unknown name 'joy'"),
    "easing is a long list": (b"[[pose]]\ntime = 1\neasing = [" + b"1," * 9000 + b"]\n", "easing"),
    "label with line end after the end": (
        b'duration = 1\n[[pose]]\ntime = 2\nname = "x\\ny"\n', "comes after the duration"
    ),
    # Tracks.
    "an unknown track": (b"[tracks]\njoi = [{time = 1, value = 1}]\n", "unknown name 'joi'"),
    "a track with line end": (b'[tracks]\n"a\\nb" = [{time = 1, value = 1}]\n', "unknown name"),
    "an empty track with line end": (b'[tracks]\n"a\\nb" = []\n', "must be a list of"),
    "a line of many numbers": (b"[tracks]\njoy = '" + b"1 " * 9000 + b"'\n", "must be a time"),
    "a line with escape": (b'[tracks]\njoy = "1 \\u001b[2J"\n', "must be a time, a value"),
    "a line of hexadecimals": (b"[tracks]\njoy = '0x1 1'\n", "must be a time, a value"),
    "lines that fall": (b"[tracks]\njoy = '''1 1\n0 1'''\n", "key 2: time 0 s does not come"),
    "lines at one time": (b"[tracks]\njoy = '''" + b"0 0\n" * 10**6 + b"'''\n", "does not come"),
    "too much outside of quotes": (b"a = [" + b"1," * 9_000_000 + b"]", "outside of quotes"),
}  # fmt: skip
