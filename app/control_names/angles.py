"""The angles to which controls turn head and eyes at 1, as the rig of all heads sets them."""

GAZE_ANGLE = 30.0  # [degrees]
# [degrees] by control; a neck turns no farther without the shoulders.
FULL_ANGLES = {
    "head_yaw": 45.0,
    "head_pitch": 30.0,
    "head_roll": 30.0,
    "gaze_horizontal_left": GAZE_ANGLE,
    "gaze_horizontal_right": GAZE_ANGLE,
    "gaze_vertical_left": GAZE_ANGLE,
    "gaze_vertical_right": GAZE_ANGLE,
}
