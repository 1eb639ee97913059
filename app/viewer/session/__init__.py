"""A user's work on a face, the face's motion, and the files of the work; independent of windows."""
