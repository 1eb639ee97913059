"""Benchmarks: each module measures one property and returns numbers and text for its command."""
