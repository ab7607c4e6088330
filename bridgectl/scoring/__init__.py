"""Scores of damper strategies: run, board, text; and the tuning of their gains: tune, search."""
