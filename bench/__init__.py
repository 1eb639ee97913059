"""Benchmarks: each room measures one thing and makes numbers and text; its commands print them."""
