"""Crossings of many different vehicles side by side in arrays: `crossings` is the way in.

A crossing's numbers are its own to the bit, whatever is beside it: products of matrices are one of
the same shape for each crossing, all else is done number by number.
"""
