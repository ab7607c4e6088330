"""The damping that is best if all of the road is known."""
