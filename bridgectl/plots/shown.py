"""What is drawn, by name alone: figures import none of it, so any result may draw itself.

A figure needs the attributes and methods of the class that is named here, in the shapes and units
that its own module tells.
"""

from typing import Any, TypeAlias

# Of bridgectl.road: RoadProfile, psd.RoadPsd, psd.PsdFit.
RoadShown: TypeAlias = Any
PsdShown: TypeAlias = Any
LineShown: TypeAlias = Any

# Beam, Moment, linear.envelope.Envelope, RampSurface, extremes.pairs.EqualRoughnessPair,
# scoring.ramp_heights.RampHeights.
BeamShown: TypeAlias = Any
EffectShown: TypeAlias = Any
EnvelopeShown: TypeAlias = Any
SurfaceShown: TypeAlias = Any
PairShown: TypeAlias = Any
RampHeightsShown: TypeAlias = Any

# model.vehicle.Vehicle, model.crossing.Crossing; of the control library: TimeResponseData.
VehicleShown: TypeAlias = Any
CrossingShown: TypeAlias = Any
ResponseShown: TypeAlias = Any

# Of bridgectl.fleet: assessment.Read, levels.Reading, tails.Tail.
ReadShown: TypeAlias = Any
ReadingShown: TypeAlias = Any
TailShown: TypeAlias = Any

# Scoreboard, scoring.changes.Robustness, Tuning; of bridgectl.paper: printed.PaperResults,
# validation.Case, validation.ValidationResults, damper_validation.DamperCase.
BoardShown: TypeAlias = Any
RobustShown: TypeAlias = Any
TuningShown: TypeAlias = Any
PaperShown: TypeAlias = Any
CaseShown: TypeAlias = Any
ValidationShown: TypeAlias = Any
DamperCaseShown: TypeAlias = Any
