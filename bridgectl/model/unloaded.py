"""A tire that a vehicle would have to hold down."""

from __future__ import annotations

from bridgectl._checks import FloatArray


class UnloadedTireError(ValueError):
    """A static load that is not above 0; `loads` are those of all tires [N]."""

    def __init__(self, loads: FloatArray) -> None:
        super().__init__(
            f"every tire must carry a static load above 0 N, got {loads} N; check mass_matrix, "
            "tire_map and heave"
        )
        self.loads = loads
