"""Benchmarks: each module measures one part and returns rows of numbers; printing is for app/."""
