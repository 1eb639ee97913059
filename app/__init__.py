"""The Risorius application: the one place that joins simulation, refinement and rendering."""
