"""The channels of a take: the names that every reader of recordings answers in, and their units.

    mouthSmileLeft ...      the 52 shapes of Apple's ARKit, 0 to 1
    AU12, AU12_left ...     action units, 0 to 1 (intensity E is 1)
    viseme_PP ...           visemes, 0 to 1
    head_yaw, head_pitch, head_roll                       [degrees]
    eye_yaw_left, eye_pitch_left, eye_yaw_right, eye_pitch_right    [degrees], in the head's frame

Left and right are the subject's own. Angles grow to the subject's left, up, and (roll) to the left
shoulder, as the controls do. Readers turn signs and units of a format; nobody after them does.

Source: Apple, ARFaceAnchor.BlendShapeLocation (the names).
"""

from __future__ import annotations

ARKIT = (
    "eyeBlinkLeft", "eyeLookDownLeft", "eyeLookInLeft", "eyeLookOutLeft", "eyeLookUpLeft",
    "eyeSquintLeft", "eyeWideLeft", "eyeBlinkRight", "eyeLookDownRight", "eyeLookInRight",
    "eyeLookOutRight", "eyeLookUpRight", "eyeSquintRight", "eyeWideRight", "jawForward", "jawLeft",
    "jawRight", "jawOpen", "mouthClose", "mouthFunnel", "mouthPucker", "mouthLeft", "mouthRight",
    "mouthSmileLeft", "mouthSmileRight", "mouthFrownLeft", "mouthFrownRight", "mouthDimpleLeft",
    "mouthDimpleRight", "mouthStretchLeft", "mouthStretchRight", "mouthRollLower",
    "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper", "mouthPressLeft", "mouthPressRight",
    "mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft", "mouthUpperUpRight",
    "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight",
    "cheekPuff", "cheekSquintLeft", "cheekSquintRight", "noseSneerLeft", "noseSneerRight",
    "tongueOut",
)  # fmt: skip
"""The 52 shapes in the order in which ARKit counts them, as packets without names do."""

HEAD_ANGLES = ("head_yaw", "head_pitch", "head_roll")
EYE_ANGLES = ("eye_yaw_left", "eye_pitch_left", "eye_yaw_right", "eye_pitch_right")
VISEMES = tuple(
    f"viseme_{sound}" for sound in "sil PP FF TH DD kk CH SS nn RR aa E ih oh ou".split()
)
