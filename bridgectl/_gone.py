"""Names that were public and went: what to type instead."""

_INSTEAD = {
    "": {"DaeTrust": "dae_trust(surface, roads)"},
    ".dampers": {
        "Bridgehook": "bridgehook(...)", "Clairvoyant": "clairvoyant(...)",
        "Costate": "costate(...)", "LoopResult": "simulate_loop(...)",
        "PeakValue": "bridgehook(...)", "Sensitivity": "program_sensitivity(...)",
    },
    ".extremes": {
        "EqualRoughnessPair": "equal_roughness_pair(...)", "ExtremeRoad": "extreme_road(...)",
    },
    ".measures": {
        "FourthPower": "aggregate_fourth_power(...)", "rms": "numpy.mean(history**2) ** 0.5",
        "largest": "numpy.abs(history).max()", "peak_to_peak": "numpy.ptp(history)",
        "least_force": "simulate_loop(...).least_force", "histories": "numpy.atleast_1d(history)",
        "road_stress_factor": "aggregate_fourth_power(...).mean",
        "switching_count": "simulate_loop(...).switches",
    },
    ".plots": {
        "lines_plot": "axes.plot(surface.positions, surface.daf_unit[i])",
        "smooth_daf_plot": "axes.plot(surface.speeds, surface.daf_smooth)",
        "pair_figure": "pair.plot(speeds, daf)", "profile_figure": "road.plot_roughness()",
        "psd_plot": "road.psd().plot()", "ramp_height_figure": "found.plot(*others)",
        "score_figure": "board.plot()", "surface_plot": "surface.plot()",
        "paper_figure": "`bridgectl paper --plot FILE` in a shell",
        "validation_figure": "`bridgectl validate --plot FILE` in a shell",
        "damper_validation_figure": "`bridgectl validate --dampers --plot FILE` in a shell",
    },
    ".road": {
        "PsdFit": "road.psd().fit()", "RoadPsd": "road.psd()", "RoadEvent": "bump(...)",
        "pothole": "bump(x, length, -depth)", "ramp_covariance": 'surface.class_dae("A")',
        "class_roughness": "16e-6 * 4**k for class A (k = 0), B (k = 1), ...",
    },
}  # fmt: skip


def no_attribute(module: str, name: str) -> AttributeError:
    """Return the error for a name that a room has not, with what to type if it once had."""
    told = _INSTEAD.get(module.removeprefix("bridgectl"), {}).get(name)
    hint = f": type {told}" if told else ""
    return AttributeError(f"module {module!r} has no attribute {name!r}{hint}")
