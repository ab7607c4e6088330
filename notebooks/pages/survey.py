"""The survey that a recipe of the cookbook reads: made here, of a road that is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import bridgectl as bc


def survey(path: str | Path = "survey.csv") -> bc.RoadProfile:
    """Write a survey of a gentle bend, with a stop and noise, and return what was there."""
    rng = np.random.default_rng(3)
    road = bc.iso8608_profile("A", 260, seed=5, step=0.05)
    drive = 0.06 + 0.02 * np.sin(np.linspace(0, 9, 5000))
    drive[1500:1800] = 0.0  # 15 s at 20 Hz
    s = np.cumsum(drive)[np.cumsum(drive) < 255]
    bend = 500.0  # m, the radius; the bridge begins 200 m from the first point
    east, north = bend * np.sin((s - 200) / bend), bend * (1 - np.cos((s - 200) / bend))
    east, north = np.array([east, north]) + rng.normal(0, 0.01, (2, s.size))
    height = 187.3 + 0.01 * s + road.elevation_at(s) + rng.normal(0, 5e-4, s.size)
    latitude = 50.0881 + np.degrees(north / 6.371e6)
    longitude = 14.4215 + np.degrees(east / 6.371e6 / np.cos(np.radians(50.0881)))
    table = np.column_stack([latitude, longitude, height])
    np.savetxt(path, table, "%.8f,%.8f,%.4f", header="latitude,longitude,height", comments="")
    return road.place_bridge(200.0)
