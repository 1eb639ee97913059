"""A user's work on a face, the face's motion in time, and files of both; knows no window."""
