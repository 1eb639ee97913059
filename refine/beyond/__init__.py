"""Beyond the paper: its future work (section 6) and what it leaves to others."""
