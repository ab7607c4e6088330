"""A crossing as a table of pandas, a ramp surface as a dataset of xarray, and both as files."""

import numpy as np

import bridgectl as bc

bridge, truck, speeds = bc.li2006.beam(), bc.li2006.car(), np.arange(60, 121, 20) / 3.6
crossing = bc.crossing_response(bridge, truck, 80 / 3.6, effects={"M": bc.Moment()})
table = crossing.to_pandas().set_index("time")
table.to_csv("crossing.csv")
print(f"{table['M'].max() / 1e3:.1f} kN m after {table['M'].idxmax():.3f} s")
surface = bc.ramp_surface(bridge, truck, speeds).to_xarray()
surface.to_netcdf("surface.nc")
print(dict(surface.sizes), list(surface.data_vars), list(surface.coords))
