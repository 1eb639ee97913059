"""What comes from files and goes into them: scripts, heads, exports, and what is asked for that."""
