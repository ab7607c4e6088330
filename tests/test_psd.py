"""Spectra of roads: of waves whose spectrum is known, and of real files."""

import numpy as np
import pytest
from scipy.special import digamma

import bridgectl as bc
from bridgectl.road.psd import BAND, PsdFit, RoadPsd, class_roughness, elevation_psd

MEANS = dict(zip("ABCDEFGH", 16e-6 * 4.0 ** np.arange(8), strict=True))


def random_walk(length, step, roughness, seed):
    """A road of independent slopes: exactly G_d(n_0) (n / n_0)^-2 where n is small."""
    slope_psd = roughness * (2 * np.pi * 0.1) ** 2
    slopes = np.random.default_rng(seed).normal(
        0, np.sqrt(slope_psd / (2 * step)), round(length / step)
    )
    x = step * np.arange(slopes.size + 1)
    return bc.RoadProfile(x, np.append(0, np.cumsum(slopes)) * step)


def test_the_density_is_one_sided_its_integral_is_the_variance_of_the_slope():
    road = random_walk(2000, 0.1, 16e-6, 0)
    psd = road.psd()
    slope_density = psd.density * (2 * np.sin(np.pi * psd.wavenumber * 0.1) / 0.1) ** 2
    integral = slope_density.sum() * psd.wavenumber[0]
    assert integral == pytest.approx(np.diff(road.elevation).var() / 0.1**2, rel=0.02)


@pytest.mark.parametrize("wavelength", [2.5, 10.0])
def test_a_sine_stands_at_its_wave_number_with_its_variance(wavelength):
    x = 0.1 * np.arange(10001)
    road = bc.RoadProfile(x, 1e-3 * np.sin(2 * np.pi * x / wavelength))
    psd = road.psd()
    peak = np.argmax(psd.density)
    assert psd.wavenumber[peak] == pytest.approx(1 / wavelength, abs=1e-3)
    around = slice(peak - 2, peak + 3)
    variance = psd.density[around].sum() * psd.wavenumber[0]
    # The window's width, in which n^-2 bends, leaves 1 % at 10 m.
    assert variance == pytest.approx(0.5e-6, rel=0.015)


def test_a_grade_and_a_level_have_no_spectrum():
    road = random_walk(500, 0.1, 16e-6, 1)
    graded = bc.RoadProfile(road.x, road.elevation + 0.03 * road.x + 200)
    assert graded.psd().density == pytest.approx(road.psd().density, rel=1e-6)


def test_the_fit_of_a_random_walk_is_its_roughness_and_waviness_two():
    fits = np.array([random_walk(1000, 0.05, 64e-6, seed).psd().fit() for seed in range(60)])
    # Its steps make short waves a little rougher: 0.7 % at 2.83 cycles/m with 50 mm.
    assert fits.mean(axis=0) == pytest.approx([64e-6, 2.0], rel=0.02)


def test_a_short_road_is_fitted_without_bias():
    """A plain mean of logarithms is 7 % low on three stretches of 100 m."""
    fits = np.array([random_walk(235, 0.05, 64e-6, seed).psd().fit() for seed in range(400)])
    assert fits[:, 0].mean() == pytest.approx(64e-6, rel=0.05)
    assert fits[:, 1].mean() == pytest.approx(2.0, abs=0.03)


def test_stretches_that_overlap_by_half_count_a_little_less_than_one_each():
    """Their Hann windows are correlated by 1/6, so their densities by 1/36."""
    assert random_walk(100, 0.1, 16e-6, 0).psd().averages == 1.0
    assert random_walk(150, 0.1, 16e-6, 0).psd().averages == pytest.approx(2 / (1 + 1 / 36))
    five = random_walk(300, 0.1, 16e-6, 0).psd().averages
    assert five == pytest.approx(5**2 / (5 + 2 * 4 / 36))


def test_a_third_octave_is_freed_of_the_bias_of_its_few_tied_densities():
    """Hann's window correlates densities with the next by 4/9 and with the second next by 1/36."""
    n = 0.01 * np.arange(1, 65)
    psd = RoadPsd(n, n**-2.0, averages=3.0)
    place, logarithm = psd._third_octaves(np.array([n[0], n[-1]]))
    which = np.floor(3 * np.log2(n / n[0])).astype(int)
    octaves = [n[which == k] for k in np.unique(which)]
    assert {len(octave) for octave in octaves} >= {1, 2, 3, 5}
    for k, octave in enumerate(octaves):
        apart = np.abs(np.subtract.outer(np.arange(octave.size), np.arange(octave.size)))
        ties = np.array([1, 4 / 9, 1 / 36, 0])[np.minimum(apart, 3)].sum() / octave.size
        m = 3.0 * octave.size / ties
        expected = np.log(np.mean(octave**-2.0)) + np.log(m) - digamma(m)
        assert logarithm[k] == pytest.approx(expected, abs=1e-12)
        assert np.log(place[k]) == pytest.approx(np.log(octave).mean(), abs=1e-12)
    assert len(place) == len(octaves)


def test_a_fit_at_waviness_two_is_that_of_the_classes():
    fit = random_walk(5000, 0.1, 16e-6, 3).psd().fit(waviness=2)
    assert fit.waviness == 2
    assert fit.roughness == pytest.approx(16e-6, rel=0.1)


def test_the_measured_road_has_the_line_of_another_program():
    """A line through all wave numbers alike: waviness about 2.8, G_d(n_0) about 82e-6 m^3.

    That line is one of short waves, which the road's file lacks. Through third octaves, as
    ISO 8608 smooths them, it is flatter.
    """
    psd = bc.utia_road().psd()
    inside = (psd.wavenumber >= BAND[0]) & (psd.wavenumber <= BAND[1])
    octaves, logarithm = np.log(psd.wavenumber[inside] / 0.1), np.log(psd.density[inside])
    slope, level = np.polyfit(octaves, logarithm, 1)
    assert np.exp(level) == pytest.approx(82e-6, rel=0.01)
    assert -slope == pytest.approx(2.8, abs=0.05)
    fit = psd.fit()
    assert fit.roughness == pytest.approx(57e-6, rel=0.02)
    assert fit.waviness == pytest.approx(2.54, abs=0.02)
    assert fit.iso_class == "B"


@pytest.mark.parametrize("name", MEANS)
def test_each_class_is_four_times_the_one_before_and_reaches_from_half_to_twice_its_mean(name):
    assert class_roughness(name) == pytest.approx(MEANS[name], rel=1e-12)
    assert class_roughness(name, "lower") == pytest.approx(MEANS[name] / 2, rel=1e-12)
    assert class_roughness(name, "upper") == pytest.approx(MEANS[name] * 2, rel=1e-12)
    for factor in (0.51, 1.0, 1.99):
        assert PsdFit(MEANS[name] * factor, 2.0).iso_class == name


def test_what_is_smoother_than_class_a_is_class_a_and_rougher_than_h_is_h():
    assert PsdFit(1e-7, 2.0).iso_class == "A"
    assert PsdFit(1.0, 2.0).iso_class == "H"


def test_a_periodogram_is_the_spectrum_of_one_stretch_without_a_window():
    road = random_walk(100, 0.1, 16e-6, 5)
    psd = road.psd(100, window="boxcar")
    slopes = np.diff(road.elevation) / 0.1
    power = np.abs(np.fft.rfft(slopes - slopes.mean())[1:]) ** 2 * 2 * 0.1 / slopes.size
    power[-1] /= 2  # the shortest wave has no negative partner
    expected = power / (2 * np.sin(np.pi * psd.wavenumber * 0.1) / 0.1) ** 2
    assert psd.density == pytest.approx(expected, rel=1e-9)


def test_many_roads_at_once_have_the_spectra_of_each():
    roads = [random_walk(300, 0.1, 16e-6, seed) for seed in range(3)]
    _, density, averages = elevation_psd([road.elevation for road in roads], 0.1)
    for row, road in zip(density, roads, strict=True):
        assert row == pytest.approx(road.psd().density, rel=1e-12)
    assert averages == roads[0].psd().averages


def test_uneven_stations_are_an_error_that_says_what_to_type():
    with pytest.raises(ValueError, match=r"PSD needs evenly spaced stations: type road\.resample"):
        bc.RoadProfile([0, 0.25, 0.6, 30], [0, 0, 0, 0]).psd()


def test_a_segment_of_a_few_steps_is_an_error():
    with pytest.raises(ValueError, match=r"segment must hold 8 steps of 0\.25 m or more, got 4"):
        bc.utia_road().psd(1.0)
    assert bc.utia_road().psd(2.0).wavenumber == pytest.approx([0.5, 1.0, 1.5, 2.0])


def test_a_band_that_holds_no_line_is_an_error():
    with pytest.raises(ValueError, match="has 0 wave numbers from 5 to 6 cycles/m, too few"):
        bc.utia_road().psd().fit(band=(5, 6))
    with pytest.raises(ValueError, match="too few for a line"):
        random_walk(20, 0.5, 16e-6, 0).psd(5.0).fit(band=(BAND[0], 0.3))


def test_a_level_road_has_no_line():
    with pytest.raises(ValueError, match="the road has no waves in a part of"):
        bc.RoadProfile([0, 100], [0, 0]).resample(0.1).psd().fit()


@pytest.mark.parametrize("height", [0.0, 1.0, 583.0])
@pytest.mark.parametrize("grade", [0.001, 0.05])
def test_the_round_off_of_a_straight_road_is_no_class(height, grade):
    x = 0.25 * np.arange(2000)
    road = bc.RoadProfile(x, height + grade * x)
    for straight in (road, road.detrend()):
        with pytest.raises(ValueError, match="the road has no waves in a part of"):
            straight.psd().fit()


def test_a_smooth_road_far_above_the_sea_has_its_class():
    road = random_walk(500, 0.25, 1e-9, 0)
    high = bc.RoadProfile(road.x, road.elevation + 4000)
    assert high.psd().fit() == pytest.approx(road.psd().fit(), rel=1e-3)
    assert high.psd().fit().iso_class == "A"


def test_a_class_that_is_none_is_an_error():
    with pytest.raises(ValueError, match="iso_class must be one of 'A', 'B'"):
        class_roughness("Z")
    with pytest.raises(ValueError, match="level must be one of 'lower', 'mean', 'upper'"):
        class_roughness("A", "middle")
