import numpy as np
import pytest

import bridgectl as bc
from bridgectl.paper.printed import paper_results


@pytest.fixture(scope="module")
def results():
    return paper_results()


def values(results, start):
    return [row.computed for row in results.rows if row.what.startswith(start)]


def test_every_printed_number_stands_beside_a_computed_one(results):
    printed = {row.printed for row in results.rows} - {None}
    assert printed == set(bc.li2006.PRINTED.values())
    for row in results.rows:
        expected = None if row.printed is None else row.computed - row.printed
        assert row.difference == expected


def test_the_computed_numbers_are_the_independently_computed_ones(results, cases):
    paper = cases["li2006"]
    assert values(results, "smooth road") == pytest.approx([1.13023], abs=3e-5)
    assert values(results, "critical speed") == [103, 108]
    ramps = paper["computed_ramps_110_kmh"]["daf_minus_smooth_1mm"]
    at_place, earlier = values(results, "1 mm ramp at 0.12 l")
    assert [earlier, at_place] == pytest.approx(ramps[:2], abs=5e-6)
    at_place, earlier = values(results, "1 mm ramp at 0.3 l")
    assert [earlier, at_place] == pytest.approx(ramps[2:], abs=5e-6)
    assert values(results, "1 mm ramp at 0.75 l") == pytest.approx([0, 0], abs=1e-9)
    assert values(results, "Fig. 7: DAE") == pytest.approx([1.06482, 1.0666], abs=5e-5)
    assert values(results, "Fig. 7: DAF")[0] == pytest.approx(1.06594, abs=5e-5)


def test_figure_2_is_the_computed_column(results, cases):
    column = cases["li2006"]["computed_li2006"]
    assert [kmh for kmh, _ in results.smooth_daf] == column["speeds_kmh"]
    assert [daf for _, daf in results.smooth_daf] == pytest.approx(column["daf_smooth"], abs=3e-5)


def test_a_10_mm_ramp_in_the_right_half_matters_only_where_it_makes_a_later_peak(
    results, bridge, truck
):
    """The paper: none. At 57 km/h the smooth road's DAF is so low that a later peak can win."""
    assert values(results, "10 mm, right half, 105") == [0.0]
    assert values(results, "10 mm, right half, any")[0] > 0.05
    speed, surface = 57 / 3.6, results.tall
    row = surface.daf_unit[np.argmin(np.abs(surface.speeds - speed))]
    right = surface.positions > 12.5
    start = surface.positions[right][np.argmax(row[right])]
    road = bc.RoadProfile([0, start, start + 0.1, 25], [0, 0, -0.01, -0.01])
    with_ramp = bc.crossing_response(bridge, truck, speed, road, recovery="li2006")
    moment = with_ramp.outputs["moment"]
    assert moment.max() == pytest.approx(row[right].max(), abs=1e-3)
    assert with_ramp.time[np.argmax(moment)] * speed > start
