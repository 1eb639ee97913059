"""Benchmarks: each module measures one thing and makes numbers and text; commands print them."""
