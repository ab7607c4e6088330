"""Fleets: random traffic and the assessment of a bridge under it."""
