"""Shared parts of docstrings are filled in."""

import re

import pytest

from bridgectl import dampers, plots, road
from bridgectl._docs import filled


def test_a_name_in_braces_becomes_the_text_with_the_names_in_it():
    @filled(all="{one}\n\nTwo.", one="One.")
    def found():
        """Sum up.

        {all}
        """

    assert found.__doc__ == "Sum up.\n\nOne.\n\nTwo."


def test_no_docstring_no_text():
    @filled(one="One.")
    def found():
        pass

    assert found.__doc__ == ""


@pytest.mark.parametrize("module", [dampers, plots, road])
def test_no_public_docstring_has_a_name_in_braces_left(module):
    for name in module.__all__:
        assert not re.search(r"^\s*\{\w+\}\s*$", getattr(module, name).__doc__ or "", re.MULTILINE)
