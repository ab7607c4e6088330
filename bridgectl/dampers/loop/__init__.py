"""The engine of closed loops: steps of many crossings at once, cut at events."""
