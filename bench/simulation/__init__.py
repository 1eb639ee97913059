"""The simulated face: its speed, whether it holds, and whether it looks as it should."""
