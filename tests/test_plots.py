import ast
from pathlib import Path

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl import plots
from bridgectl.extremes import equal_roughness_pair
from bridgectl.paper.printed import paper_results
from bridgectl.plots import dae_figure
from bridgectl.plots.surface import paper_figure, smooth_daf_plot, surface_plot
from bridgectl.road.psd import class_roughness


@pytest.fixture(scope="module")
def surface(bridge, truck):
    return bc.ramp_surface(bridge, truck, np.arange(60, 121, 20) / 3.6, approach=50, ramp_length=1)


def labels(figure):
    return [axes.get_xlabel() for axes in figure.axes] + [a.get_ylabel() for a in figure.axes]


def test_the_dae_figure_has_units_on_every_labelled_axis(surface, tmp_path):
    road = rough_road(1, -50, 25)
    figure = dae_figure(surface, road)
    told = {label for label in labels(figure) if label}
    assert told == {
        "speed [km/h]",
        "amplification DAF, DAE [-]",
        "elevation [mm]",
        "x from the start of the bridge [m]",
        "contribution to DAE [-]",
    }
    assert len(figure.axes) == 5  # speeds; road and ramps, whole and enlarged
    figure.savefig(tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 20_000


def test_the_dae_figure_draws_the_surfaces_own_numbers(surface):
    road = rough_road(1, -50, 25)
    figure = dae_figure(surface, road, simulated=surface.superposed_daf(road))
    curves = {line.get_label(): line.get_ydata() for line in figure.axes[0].lines}
    assert curves["DAE"] == pytest.approx(surface.dae(road))
    assert curves["DAF, smooth road"] == pytest.approx(surface.daf_smooth)
    assert curves["superposed DAF"] == pytest.approx(curves["simulated DAF"])


@pytest.mark.parametrize(
    ("elevation", "expected"),
    [
        ([0, 0, -0.002, -0.002], ["raises it", "1 largest"]),
        ([0, 0, 0.002, 0.002], ["lowers it", "1 largest"]),
        ([0, 0, 0, 0], []),
    ],
)
def test_a_legend_names_what_is_drawn_of_a_road_with_one_ramp(bridge, truck, elevation, expected):
    surface = bc.ramp_surface(bridge, truck, [110 / 3.6], ramp_length=0.5)
    figure = dae_figure(surface, bc.RoadProfile([0, 8.0, 8.5, 25], elevation))
    (axes,) = (axes for axes in figure.axes if "contribution" in axes.get_ylabel())
    legend = axes.get_legend()
    assert ([] if legend is None else [text.get_text() for text in legend.get_texts()]) == expected


def test_without_an_approach_the_bridge_needs_no_enlargement(bridge, truck):
    surface = bc.ramp_surface(bridge, truck, [20.0, 30.0])
    figure = dae_figure(surface, bc.li2006.fig7_road())
    assert len(figure.axes) == 3


def test_a_surface_draws_itself(surface):
    axes = surface.plot()
    assert axes.get_xlabel() == "start of the ramp, x/l [-]"
    assert (
        surface.plot(difference=True).get_title(loc="left") == "what a 1 mm drop over 1 m changes"
    )


def test_speeds_are_drawn_in_order_whatever_their_order_was(bridge, truck):
    surface = bc.ramp_surface(bridge, truck, [30.0, 20.0], ramp_length=5)
    line = smooth_daf_plot(surface).lines[0]
    assert line.get_xdata() == pytest.approx([72, 108])
    assert line.get_ydata() == pytest.approx(surface.daf_smooth[::-1])


def test_a_surface_of_one_speed_cannot_be_drawn(bridge, truck):
    surface = bc.ramp_surface(bridge, truck, 30.0, ramp_length=5)
    with pytest.raises(ValueError, match="surface must have two speeds or more"):
        surface_plot(surface)


def test_the_papers_figures_are_five_titled_panels():
    figure = paper_figure(paper_results())
    titles = [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]
    starts = [title.split(":")[0] for title in titles]
    assert starts == ["Fig. 2", "Fig. 5(a)", "Fig. 5(b)", "Fig. 6(a)", "Fig. 6(b)"]


def test_a_dollar_sign_in_a_roads_name_is_no_formula(bridge, truck, tmp_path):
    surface = bc.ramp_surface(bridge, truck, [20.0, 30.0])
    flat = bc.RoadProfile([0, 25], [0, 0], name=r"cost $\x$")
    dae_figure(surface, flat).savefig(tmp_path / "figure.png")


def test_a_place_that_changes_nothing_has_the_middle_colour(surface):
    bar = surface_plot(surface, difference=True).figure.axes[1]
    assert 0.0 in bar.get_yticks()


def test_the_spectrum_is_drawn_with_its_line_and_the_classes(truck):
    psd = bc.utia_road().psd()
    axes = psd.plot()
    assert axes.get_xlabel() == "wave number n [cycles/m]"
    assert axes.get_ylabel() == "power spectral density $G_d$ [m³]"
    drawn, line = axes.lines
    assert drawn.get_ydata() == pytest.approx(psd.density)
    assert "class B, w = 2.54" in line.get_label()
    assert {text.get_text() for text in axes.texts} >= {"A", "B", "C"}


def test_the_profile_figure_shows_each_segments_iri():
    road = bc.utia_road()
    figure = road.plot_roughness(segment=100)
    stairs = figure.axes[1].patches[0]
    assert stairs.get_data().values == pytest.approx(road.iri(segment=100))


def test_the_pair_figure_draws_both_roads_and_both_dafs(bridge, truck):
    speeds = np.arange(80, 101, 10) / 3.6
    surface = bc.ramp_surface(bridge, truck, speeds, approach=20)
    road = bc.iso8608_profile("A", 45, seed=1, start=-20)
    pair = equal_roughness_pair(surface, road, float(speeds[1]))
    dafs = [bc.daf(bridge, truck, speeds, each, start=-20) for each in (pair.first, pair.second)]
    figure = pair.plot(speeds, dafs, smooth=surface.daf_smooth)
    assert all(text for text in labels(figure))
    curves = {line.get_label(): line.get_ydata() for line in figure.axes[2].lines}
    assert curves["case 2"] == pytest.approx(dafs[1])


def test_figures_import_nothing_of_what_they_draw():
    """But for modules of an underscore and each other: so any result may draw itself."""
    for path in Path(plots.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = node.names if isinstance(node, ast.Import | ast.ImportFrom) else []
            for name in names:
                module = f"{getattr(node, 'module', '')}.{name.name}".strip(".")
                ours = module.split(".")[0] == "bridgectl"
                assert not ours or module.startswith(("bridgectl.plots.", "bridgectl._")), path.name


@pytest.mark.parametrize("level", ["lower", "mean", "upper"])
def test_a_spectrum_knows_the_classes_that_it_is_drawn_over(level):
    """Their densities are those of the standard's own roughness, at n_0 and a decade above it."""
    psd, i = bc.utia_road().psd(), ["lower", "mean", "upper"].index(level)
    assert list(psd.classes) == list("ABCDEFGH")
    for name, lines in psd.classes.items():
        expected = class_roughness(name, level)
        assert lines[i].density([0.1, 1.0]) == pytest.approx([expected, expected / 100])
