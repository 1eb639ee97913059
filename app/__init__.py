"""The Risorius application, which joins simulation, refinement and rendering."""
