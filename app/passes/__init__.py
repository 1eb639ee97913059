"""The content of a picture as numbers: depth, normals, classes, landmarks, the camera."""
