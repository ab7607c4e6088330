"""Take a crossing to pandas and a ramp surface to xarray, and both to files."""

import numpy as np

import bridgectl as bc

bridge, truck, speeds = bc.li2006.beam(), bc.li2006.car(), np.arange(60, 121, 20) / 3.6
crossing = bc.crossing_response(bridge, truck, 25.0, effects={"M": bc.Moment()})
table = crossing.to_pandas()
table.to_csv("crossing.csv", index=False)
print(f"{table['M'].max() / 1e3:.1f} kN m at {table.set_index('time')['M'].idxmax():.3f} s")
surface = bc.ramp_surface(bridge, truck, speeds).to_xarray()
surface.to_netcdf("surface.nc")
print(surface)
