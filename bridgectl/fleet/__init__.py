"""Fleets of trucks: drawn from distributions with a seed, or weighed on a road."""
