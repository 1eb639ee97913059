"""Write the motion of a script as files for other programs."""
