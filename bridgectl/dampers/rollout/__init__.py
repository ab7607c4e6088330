"""Rollouts: dampers that predict what is to come of a few dampings, and take the best."""
