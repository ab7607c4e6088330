"""What `import bridgectl` offers is documented, and what is documented is offered."""

import inspect
import re

import pytest

import bridgectl as bc

EXCEPTIONS = {
    "LiftOffWarning",
    "ProfileFileError",
    "SurfaceFileError",
}  # take what every exception takes
DOCUMENTED = sorted(name for name in set(bc.__all__) - EXCEPTIONS if callable(getattr(bc, name)))


@pytest.mark.parametrize("name", bc.__all__)
def test_a_public_name_exists_and_has_a_docstring(name):
    assert inspect.getdoc(getattr(bc, name))


@pytest.mark.parametrize("name", DOCUMENTED)
def test_every_argument_of_a_public_name_is_documented(name):
    thing = getattr(bc, name)
    text = inspect.getdoc(thing)
    for argument in inspect.signature(thing).parameters:
        assert re.search(rf"^(.*, )?{argument}(, .*)?( :|$)", text, re.MULTILINE), argument


def test_an_unknown_keyword_is_an_error_that_names_it(bridge, truck):
    with pytest.raises(TypeError, match="speeed"):
        bc.crossing_response(bridge, truck, speeed=30.0)


def test_the_package_is_typed():
    from importlib.resources import files

    assert files("bridgectl").joinpath("py.typed").is_file()
