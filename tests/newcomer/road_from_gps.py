"""A road from a survey with GPS: latitude, longitude and height, with stops and noise."""

import numpy as np

import bridgectl as bc

survey = np.genfromtxt("survey.csv", delimiter=",", names=True)
abutment = np.radians([50.0881, 14.4215])  # latitude and longitude of the start of the bridge
north = 6.371e6 * (np.radians(survey["latitude"]) - abutment[0])
east = 6.371e6 * (np.radians(survey["longitude"]) - abutment[1]) * np.cos(abutment[0])
whole = bc.RoadProfile.from_survey(east, north, survey["height"], bridge=(0, 0), name="survey")
print(whole)
short = whole.crop(-100, 25).detrend()
daf = bc.daf(bc.li2006.beam(), bc.li2006.car(), 80 / 3.6, short, start=-100)[0]
print(f"IRI {short.iri():.2f} m/km, DAF {daf:.3f} at 80 km/h")
