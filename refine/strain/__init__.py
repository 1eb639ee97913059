"""Strain: how far the skin is stretched and compressed, for artists. Not in the paper."""
