"""Recordings that nobody should have, and what is told of each; good ones of every format.

A row is a name, the file's bytes, and words of the message.
"""

from __future__ import annotations

import json

import numpy as np

from tests.app.recording_files import live_link, openface, pyfeat, table

HEADER = b"Timecode,BlendShapeCount,JawOpen\n"
ROW = b"10:00:00:00.000,61,0.5\n"
DEEP = 100_000  # brackets
ODD = "\u202e"  # turns what follows around
PICTURE = [{"category_name": "jawOpen", "score": "0.5"}, {"category_name": "cheekPuff", "score": 0}]
TRACKS = {"channels": [{"name": "PP", "keys": [[0, 0.1], [0.2, 0.4], [0.4, 0]]}]}
CUES = {"mouthCues": [{"start": 0.0, "end": 0.2, "value": "A"}, {"start": 0.2, "value": "X"}]}
FILM = {"frames": [{"t": n / 30, "blendshapes": {"jawOpen": n / 9}} for n in range(9)]}
SIDES = {"time": np.arange(9) / 30, "mouthSmile_L": np.arange(9) / 9, "AU12_L": np.zeros(9)}

GOOD: dict[str, bytes] = {
    "Live Link Face": table(live_link(20)).encode(),
    "OpenFace": table(openface(20)).encode(),
    "py-feat": table(pyfeat(10)).encode(),
    "named columns": table(SIDES).encode(),
    "a picture": json.dumps(PICTURE).encode(),
    "a film": json.dumps(FILM).encode(),
    "tracks": json.dumps(TRACKS).encode(),
    "cues": json.dumps(CUES).encode(),
    "cues in rows": b"0.00\tX\n0.20\tA\n0.45\tD\n1.00\tX\n",
}

REFUSED: dict[str, tuple[bytes, str]] = {
    # Files.
    "empty": (b"", "is empty"),
    "zeros": (bytes(1000), "not a text file"),
    "half of UTF-16": (b"\xff\xfeT", "known are"),
    # What is no table.
    "OBJ": (b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "no table and no JSON"),
    # Tables.
    "a name with escape": (b"da\x1b[2Jte,price\n1,2\n", "no column is known"),
    "header only": (HEADER, "no rows"),
    "no times": (HEADER + b"so:on,61,0.5\nla:ter,61,0.5\n", "no row has a time"),
    "no numbers": (HEADER + ROW.replace(b"0.5", b"wide") * 2, "no frame shows a face"),
    "too few cells": (HEADER + b"10:00:00:00\n" * 3, "line 2 has 1 cell, the header has 3"),
    "too many cells": (HEADER + ROW[:-1] + b",1,1\n", "line 2 has 5 cells, the header has 3"),
    "most rows too short": (HEADER + ROW + b"10:00\n" * 5, "line 3 has 1 cell"),
    "no face": (b"timestamp,success,AU01_r,AU12_r\n0,0,1,1\n0.03,0,1,1\n", "no frame shows"),
    # JSON.
    "an open bracket": (b"{", "not valid JSON"),
    "deep lists": (b"[" * DEEP + b"]" * DEEP, "brackets are nested too deep"),
    "an empty list": (b"[]", "without shapes"),
    "scores that are none": (b'[{"category_name": "jawOpen", "score": "x"}]', "no frame"),
    # Speech.
    "a wrong row": (b"0.0\tX\n0.1\tQ\n", "line 2, 'value': was 'Q'"),
    "a row without time": (b"0.0\tX\nsoon\tA\n", "line 2, 'start': was nan"),
}
