"""What a picture shows, as numbers: depth, normals, classes, landmarks, the camera."""
