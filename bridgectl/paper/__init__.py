"""Li, OBrien and Gonzalez (2006): parameters, printed numbers, validation."""
