"""Ramp surfaces: the DAE and all that reads from the amplification of unit ramps."""
