"""What is played: films, long recordings, live faces, and the window."""
