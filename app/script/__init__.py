"""Animation scripts: keyframes of controls over time, in a TOML file.

A script is a list of poses and, beside them, tracks::

    title = "Hello"              # optional
    scene = "face"               # optional: face (default), plane or cloth
    camera = "three-quarter"     # optional: a named view
    sound = "hello.wav"          # optional: what is heard with it, as seen from the script
    duration = 4.0               # optional [s]; the default is the time of the last key

    [[pose]]                     # a whole pose: what it does not name is 0
    time = 0.0                   # [s]

    [[pose]]
    time = 1.0
    easing = "smooth"            # how this pose is approached, see easing.py
    name = "joy"                 # optional: the label of this key pose on a contact sheet
    joy = 1.0                    # a control of any layer: an expression, an action unit,
    jaw_open = 0.1               # a viseme, a muscle, the jaw, the gaze

    [tracks]                     # single channels, added to the poses (a blink, a glance)
    blink = [
        { time = 2.0, value = 0 },
        { time = 2.12, value = 1, easing = "ease-in" },
        { time = 2.3, value = 0 },
    ]
    smile = '''
    2.0 0.1
    2.0167 0.12
    '''                          # lines of time and value, eased linearly, as recordings have

Before its first key a channel keeps that key's value, after its last key the last one's.
`docs/scripts.md` is the user's page of this format.
"""

from .model import (
    DECIMALS,
    EASING_NAMES,
    LARGEST,
    LONGEST_FILE,
    Channel,
    Floats,
    Key,
    Limits,
    Pose,
    Script,
    rounded,
)
from .reader import load_script, parse_script, preface_of
from .thinning import TOLERANCE, thinned
from .writer import POSE_SECONDS, is_pose, pose_script, save_script, script_text

__all__ = [
    "DECIMALS",
    "EASING_NAMES",
    "LARGEST",
    "LONGEST_FILE",
    "POSE_SECONDS",
    "TOLERANCE",
    "Channel",
    "Floats",
    "Key",
    "Limits",
    "Pose",
    "Script",
    "is_pose",
    "load_script",
    "parse_script",
    "pose_script",
    "preface_of",
    "rounded",
    "save_script",
    "script_text",
    "thinned",
]
