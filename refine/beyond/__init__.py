"""Methods beyond the paper: its future work (section 6), and methods of other authors."""
