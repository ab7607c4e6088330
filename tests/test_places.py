"""Places along a road: counted and laid out without round-off, and what a drop is there."""

import numpy as np
import pytest

from bridgectl._places import count_pieces, even_places, whole_pieces
from bridgectl.road.elevations import drops_of
from bridgectl.surface.ramps import ends_of_ramps, one_ramp


@pytest.mark.parametrize(("way", "whole", "covering"), [(0.3, 3, 3), (0.35, 3, 4), (0.0, 0, 0)])
def test_round_off_makes_no_piece_more_or_less(way, whole, covering):
    assert whole_pieces(way, 0.1) == whole
    assert count_pieces(way, 0.1) == covering


def test_equal_steps_do_not_add_up_their_round_off():
    assert even_places(-1.0, 0.1, 11)[10] == 0.0
    assert even_places(-1.0, 0.1, 0).size == 0


def test_a_ramp_that_falls_has_a_positive_drop_from_its_end_on():
    ends = ends_of_ramps(even_places(0.0, 0.5, 3), 0.5)
    assert ends.tolist() == [0.0, 0.5, 1.0, 1.5]
    roads = one_ramp(ends, 1, np.array([0.01, -0.02]))
    assert drops_of(roads).T.tolist() == [[0, 0, 0.01, 0.01], [0, 0, -0.02, -0.02]]
    assert one_ramp(ends, 1, 0.01).tolist() == roads[0].tolist()
