"""Parts of any study in a file: of numbers of several kinds, and left on the disk if asked."""

import numpy as np
import pytest

from bridgectl import _progress
from bridgectl._parts import Kind, Parts

KIND = Kind("an assessment", 1, finite=False)
SHAPES = {("crossings 0", "a"): {"daf": (3,), "kind": (3,), "flies": (3,)}}
PART = {
    "daf": np.array([1.0, np.nan, 1 / 3]),
    "kind": np.array([1, 2, 3]),
    "flies": np.array([True, False, True]),
}


@pytest.mark.parametrize("in_memory", [True, False])
def test_floats_whole_numbers_and_truth_values_come_back_to_the_bit(tmp_path, in_memory):
    for _ in range(2):
        with Parts(tmp_path / "kept", {}, SHAPES, KIND, in_memory=in_memory) as parts:
            if ("crossings 0", "a") not in parts:
                parts.keep("crossings 0", "a", PART)
            assert bool(parts.found) is in_memory
            for name, values in parts["crossings 0", "a"].items():
                np.testing.assert_array_equal(values, PART[name], strict=True)


def test_a_file_that_is_changed_while_it_is_in_use_is_not_believed(tmp_path):
    file = tmp_path / "kept"
    with Parts(file, {}, SHAPES, KIND, in_memory=False) as parts:
        parts.keep("crossings 0", "a", PART)
        file.write_bytes(file.read_bytes().replace(b"[1.0", b"[2.0"))
        with pytest.raises(ValueError, match="was changed while it was in use"):
            parts["crossings 0", "a"]


def test_a_study_is_called_by_its_name(tmp_path):
    (tmp_path / "other").write_text("x\n")
    with pytest.raises(ValueError, match="is no file of an assessment"):
        Parts(tmp_path / "other", {}, SHAPES, KIND).__enter__()


@pytest.mark.parametrize(
    ("done", "left", "spent", "told"),
    [
        (1000, 9000, 10.0, "100 crossings/s, 0:01:30 left"),
        (5, 10, 600.0, "0.5 crossings/min, 0:20:00 left"),
        (0, 10, 600.0, ""),
    ],
)
def test_the_rate_is_of_what_is_done_now(done, left, spent, told):
    assert _progress._pace(done, left, spent, "crossings") == told
