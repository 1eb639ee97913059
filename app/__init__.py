"""The Risorius application: the one place that joins simulation, refinement and rendering."""

__version__ = "0.1.0"
