"""What crosses and what is crossed: bridge, vehicle, load effects, the crossing of both."""
