"""Scores of damper strategies: run, board, text and the file of work in progress."""
