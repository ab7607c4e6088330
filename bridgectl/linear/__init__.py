"""The engine of linear crossings: exact cells, runs over a road, lift-off, peaks."""
