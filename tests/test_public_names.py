"""What bridgectl offers is documented, with units, and what is documented is offered.

The public names are those of ``__all__`` where a module has one, and those of `OFFERED`
elsewhere. Of a class, its own public methods and properties count, and those it inherits from
another class of the package.
"""

import ast
import importlib
import inspect
import json
import re
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import bridgectl as bc
from bridgectl import _gone, dampers, measures
from bridgectl.dampers import passive_theory
from bridgectl.dampers.optimum.clairvoyant import Clairvoyant
from bridgectl.dampers.peak_value import peak_value
from bridgectl.extremes import equal_roughness_pair, extreme_road
from bridgectl.fleet import words
from bridgectl.paper import printed as paper
from bridgectl.paper.damper_validation import DamperCase, Wrong
from bridgectl.paper.validation import Case, ValidationResults, WarningLight
from bridgectl.road import bump
from bridgectl.road.psd import PsdFit
from bridgectl.scoring.agreement import Agreement, Paired, Pairs
from bridgectl.scoring.board import Scoreboard
from bridgectl.scoring.rows import MEASURES, ClassRow, Ranking

ROOT = Path(__file__).parents[1]
ROOMS = ("dampers", "extremes", "measures", "plots", "road")
WITH_ALL = ("bridgectl", *(f"bridgectl.{room}" for room in ROOMS), "bridgectl.model.trucks")

OFFERED = {
    "bridgectl.paper.good_roads": ["good_roads"],
    "bridgectl.paper.li2006": ["beam", "car", "fig7_road"],
    "bridgectl.dampers.passive_theory": [
        "comfort_damping",
        "invariant_frequencies",
        "road_damping",
    ],
}
"""Public names of modules without ``__all__``; what else is there is for the package itself."""

NUMBERS = re.compile(r"\b(float|ArrayLike|FloatArray|ndarray)\b")
"""Annotations of what has a unit, or says that it has none."""

UNIT = re.compile(r"\[[^\[\]'`\"]+\]|\b[Ii]n (the unit|N |m/s|Hz|rad/s|km/h)|%")
DIMENSIONLESS = re.compile(
    r"\b([Ff]ractions?|[Rr]atios?|[Ss]hares?|[Dd]imensionless|[Nn]umber of|[Cc]ounts?|[Ff]actors?|"
    r"DAFs?|DAEs?|[Aa]mplifications?|correlation|[Ee]xponent)\b"
)
ELSEWHERE = re.compile(r"\b([Ss]ee|[Aa]s( in)?) `")


class Offer(NamedTuple):
    """A function, a class, or a method or property of a class that is public."""

    name: str
    thing: Any
    owner: type | None = None

    @property
    def is_class(self) -> bool:
        return inspect.isclass(self.thing)

    @property
    def is_error(self) -> bool:
        return self.is_class and issubclass(self.thing, BaseException)

    @property
    def function(self) -> Any:
        """What is called, or None: errors take what every exception takes."""
        if isinstance(self.thing, property):
            return self.thing.fget
        if isinstance(self.thing, cached_property):
            return self.thing.func
        return None if self.is_error else getattr(self.thing, "__func__", self.thing)

    @property
    def is_property(self) -> bool:
        return isinstance(self.thing, property | cached_property)

    @property
    def document(self) -> str:
        return inspect.getdoc(self.thing) or ""

    @property
    def sections(self) -> dict[str, str]:
        """Sections of the docstring by their headings; what is before the first is ''."""
        parts = re.split(r"^([A-Z][\w ]+)\n-{3,}\n", self.document, flags=re.MULTILINE)
        return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}

    @property
    def parameters(self) -> dict[str, inspect.Parameter]:
        if self.function is None or self.is_property:
            return {}
        found = dict(inspect.signature(self.function).parameters)
        if self.owner is not None:
            found.pop("self", None)
            found.pop("cls", None)
        return found

    @property
    def told(self) -> dict[str, str]:
        """What the docstring says of each parameter or attribute, its type included."""
        told = _fields(self.thing) if self.is_class else {}
        for heading in ("Parameters", "Attributes"):
            for entry in re.split(r"\n(?=\S)", self.sections.get(heading, "")):
                names, _, rest = entry.partition("\n")
                names, _, kind = names.partition(" : ")
                told |= {name.strip(" *"): f"{kind}\n{rest}" for name in names.split(",")}
        return told


def _fields(cls: type) -> dict[str, str]:
    """Strings after the fields of a class."""
    body = ast.parse(textwrap.dedent(inspect.getsource(cls))).body[0].body
    return {
        field.target.id: text.value.value
        for field, text in pairwise(body)
        if isinstance(field, ast.AnnAssign)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
    }


def _names() -> list[tuple[str, str]]:
    """Modules, and names that they offer."""
    return [
        (module, name)
        for module in (*WITH_ALL, *OFFERED)
        for name in OFFERED.get(module) or importlib.import_module(module).__all__
    ]


def _offers() -> Iterator[Offer]:
    seen = set()
    for module, name in _names():
        thing = getattr(importlib.import_module(module), name)
        if callable(thing) and id(thing) not in seen:
            seen.add(id(thing))
            yield Offer(f"{module}.{name}", thing)
            if inspect.isclass(thing):
                yield from _members(f"{module}.{name}", thing)


def _members(name: str, cls: type) -> Iterator[Offer]:
    for member in dir(cls):
        owner = next(c for c in cls.__mro__ if member in vars(c))
        thing = vars(owner)[member]
        is_field = inspect.isdatadescriptor(thing) and not isinstance(thing, property)
        if member.startswith("_") or not owner.__module__.startswith("bridgectl") or is_field:
            continue
        if inspect.isroutine(thing) or isinstance(thing, property | cached_property):
            yield Offer(f"{name}.{member}", thing, owner)


OFFERS = list(_offers())
TOP = {offer.name: offer for offer in OFFERS if offer.owner is None}


def _with_members(name: str) -> list[Offer]:
    return [offer for offer in OFFERS if f"{offer.name}.".startswith(f"{name}.")]


def _checks(offer: Offer) -> bool:
    """Whether the code itself checks what it is given: raises, or calls a check."""
    makers = [offer.function]
    if offer.is_class:
        makers = [vars(offer.thing).get(name) for name in ("__init__", "__post_init__")]
    nodes: list[ast.AST] = []
    for maker in makers:
        try:
            nodes += ast.walk(ast.parse(textwrap.dedent(inspect.getsource(maker))))
        except (OSError, TypeError):  # made by dataclass or NamedTuple
            continue
    return any(
        isinstance(node, ast.Raise)
        or (isinstance(node, ast.Name) and node.id in ("check", "_checks"))
        for node in nodes
    )


def _returned(offer: Offer) -> str:
    """What is returned, as it is annotated; nothing of classes and of what returns nothing."""
    if offer.function is None or offer.is_class:
        return ""
    return str(inspect.signature(offer.function).return_annotation).removeprefix("None")


def _has_unit(text: str) -> bool:
    return any(pattern.search(text) for pattern in (UNIT, DIMENSIONLESS, ELSEWHERE))


def test_there_are_few_public_names_and_each_is_offered_once():
    names = [name for _, name in _names()]
    assert len(TOP) <= 107
    assert sorted(names) == sorted({*names})


def _used(text: str) -> set[tuple[str, str]]:
    """Modules and names that Python in a text imports of bridgectl, and attributes of bc."""
    named = re.findall(r"from (bridgectl[\w.]*) import (\([^)]+\)|.+)", text)
    found = {(module, name) for module, names in named for name in re.findall(r"\w+", names)}
    return found | {("bridgectl", name) for name in re.findall(r"\bbc\.(\w+)", text)}


KNOWN = {*_names(), *(("bridgectl", room) for room in bc._ROOMS)}


def test_readme_and_notebooks_use_what_is_offered():
    """But for the inside of bridgehook, which one notebook opens."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for path in ROOT.glob("notebooks/*.ipynb"):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        text += "".join("\n" + "".join(cell["source"]) for cell in cells)
    inside = {("bridgectl.dampers.peak_value", "peak_value")}
    assert len(_used(text)) > 40
    assert _used(text) - KNOWN == inside


@pytest.mark.parametrize("name", TOP)
def test_examples_use_what_is_offered(name):
    for offer in _with_members(name):
        assert _used(offer.sections.get("Examples", "")) <= KNOWN, offer.name


GONE = [(f"bridgectl{room}", name) for room, names in _gone._INSTEAD.items() for name in names]


@pytest.mark.parametrize(("module", "name"), GONE)
def test_a_name_that_went_is_an_error_that_says_what_to_type(module, name):
    with pytest.raises(AttributeError, match=rf"^module '{module}' has no .*'{name}': type \S"):
        getattr(importlib.import_module(module), name)


@pytest.mark.parametrize("room", ROOMS)
def test_a_name_that_never_was_is_a_plain_error(room):
    with pytest.raises(AttributeError, match=rf"^module 'bridgectl.{room}' .* 'absent'$"):
        _ = getattr(bc, room).absent


@pytest.mark.parametrize("name", bc.__all__)
def test_a_public_name_exists_and_has_a_docstring(name):
    assert inspect.getdoc(getattr(bc, name))


@pytest.mark.parametrize("name", TOP)
def test_every_argument_and_field_is_documented(name):
    for offer in _with_members(name):
        fields = getattr(offer.thing, "_fields", ()) if offer.is_class else ()
        assert offer.document, offer.name
        assert {*offer.parameters, *fields} <= {*offer.told}, offer.name


@pytest.mark.parametrize("name", TOP)
def test_numbers_have_units_or_say_that_they_have_none(name):
    for offer in _with_members(name):
        told = offer.told
        for key, parameter in offer.parameters.items():
            if NUMBERS.search(str(parameter.annotation)):
                assert _has_unit(told[key]), f"{offer.name}: {key}"
        if NUMBERS.search(_returned(offer)):
            assert _has_unit(offer.sections[""] + offer.sections.get("Returns", "")), offer.name


@pytest.mark.parametrize("name", TOP)
def test_what_returns_or_checks_has_the_section(name):
    for offer in _with_members(name):
        if offer.is_property:
            continue
        assert not _checks(offer) or "Raises" in offer.sections, offer.name
        # A method without arguments tells what it returns in its first line.
        short = offer.owner and not offer.parameters and offer.document.startswith("Return ")
        assert not _returned(offer) or "Returns" in offer.sections or short, offer.name


@pytest.mark.parametrize("name", [name for name, offer in TOP.items() if not offer.is_error])
def test_every_function_and_class_has_an_example(name):
    offer = TOP[name]
    if ">>> " in offer.sections.get("Examples", ""):
        return
    # A class that only a function makes shares the example of that function.
    maker = re.search(r"\b(made|found) by `(?:[\w.]+\.)?(\w+)`", offer.document, re.IGNORECASE)
    assert offer.is_class
    assert maker
    makers = [other for key, other in TOP.items() if key.endswith(f".{maker[2]}")]
    assert any(">>> " in other.sections.get("Examples", "") for other in makers)


QUANTITY = re.compile(r"\d (m|N|kg|s|Hz|J|mm|ms|m/s|m/km|km/h|cycles/m|kN|1/\(N s\))\b")
DIMENSIONLESS_CLASSES = (
    Wrong, Agreement, ClassRow, Paired, Pairs, Ranking, WarningLight, bc.TireForce,
    bc.BodyAcceleration,
)  # fmt: skip


def rigid_body():
    axles = [bc.trucks.Axle(place, 900, 6e6, 1.75e6) for place in (0.0, 5.0)]
    return bc.trucks.Body(1e4, 5e4, axles, centre=2.5)


@pytest.fixture(scope="module")
def things(bridge, truck):
    """One of every public class, and of what a public function returns."""
    speeds = [22.0, 25.0]
    road = bc.iso8608_profile("A", 25, seed=1)
    surface = bc.ramp_surface(bridge, truck, speeds, ramp_length=0.5)
    hook = dampers.bridgehook(bridge, truck, 1e3, 30e3, lag=0.01)
    loop = dampers.passive(7e3), speeds, road.x, road.elevation
    case = Case(
        25.0, 0.0, 1, surface.speeds, *[surface.daf_smooth] * 4, np.zeros(2, dtype=bool), None
    )
    x = np.linspace(0, 25, 251)
    board = Scoreboard(
        ("passive", "skyhook"), (7e3, np.nan), ("one", "two"), surface.speeds,
        dict.fromkeys(MEASURES, np.ones((2, 2, 2))), np.ones((2, 2)), np.ones((2, 2)),
        bridge, truck, 0.0,
    )  # fmt: skip
    assessment = bc.Assessment({
        **dict.fromkeys(["kind", "road", "quality"], np.full(2, "")),
        **dict.fromkeys(words.USUAL[:2] + words.USUAL[5:], np.ones(2)),
        **{f"{of} moment": np.ones(2) for of in words.OF_EFFECT},
    }, {"moment": "N m"})  # fmt: skip
    daf = np.ones((2, 2, 3))
    tuned = bc.Tuning(
        dampers.hybrid(1e3, 30e3), ("share",), np.array([0.5]), np.array([0.4]),
        np.array([[0.0, 1.0]]), "daf", "generations", np.inf, np.ones(3), surface.speeds, daf, daf,
        {}, 1.0, False, bridge, truck, 0.0,
    )  # fmt: skip
    result = paper.Row("critical speed", "km/h", 105.0, 104.0)
    light = WarningLight(0.02, 100, 10, 8, 7)
    order = Agreement(0.8, 0.7, 0.9), Pairs(41, 44)
    daf = 1 + 0.1 * np.random.default_rng(0).normal(size=(3, 2, 2, 1))
    judged = DamperCase(25.0, "A", ("a", "b", "c"), 2, daf, daf, daf, np.array([1.0, 1.1, 1.2]))
    return [
        bridge, truck, truck.linear, bc.Crossing(bridge, truck), road, surface, board, assessment,
        tuned,
        *[board.rows()[0], board.difference("skyhook"), bc.dae_trust(surface, road)],
        bc.prediction_matrices(bridge, truck, 25.0), bc.Moment(10.0), bc.Deflection(10.0),
        bc.TireForce(), bc.BodyAcceleration(), bc.Motion(25.0), bc.Shear(10.0), bc.Reaction(10.0),
        bc.Stress(10.0, section_modulus=1.0), bc.BridgeAcceleration(10.0),
        bc.Bridge([25, 20], 18358, 4.865e10), bc.envelope(bridge, truck, 25.0, at=[5.0]),
        *[bc.trucks.Axle(0.0, 900, 6e6, 1.75e6), bc.trucks.load("T2"), rigid_body()],
        bc.Fleet({"T2": 1}, speed=22.0),
        bc.ModalBridge([0, 10, 25], np.eye(3), [4.0, 16.0, 36.0], 2e5),
        dampers.skyhook(1e3, 30e3), hook, dampers.preset(1e3, 30e3), dampers.Damper(hook, lag=0.01),
        dampers.Sensors.kalman(truck), dampers.measured(hook, dampers.Sensors.complementary()),
        dampers.costate(bridge, truck, 25.0), peak_value(bridge, truck, 25.0, 1e3, 30e3),
        dampers.simulate_loop(bridge, truck, *loop, record=["tire_force"]),
        bc.ramp_heights(bridge, truck, dampers.passive(7e3), 25.0, 5.0, approach=0.0),
        dampers.program_sensitivity(bridge, truck, 25.0, [0], [7e3], road.x, road.elevation),
        Clairvoyant(1.0, 1.1, x, 1e3 + x, 0.01, 1e3, 30e3, "solved"),
        dampers.damper_bound(bridge, truck, 25.0, road, 1e3, 30e3, step=0.2),
        equal_roughness_pair(surface, road, 25.0), extreme_road(surface, speed=25.0),
        PsdFit(16e-6, 2.0), bc.utia_road().psd(), bump(-5.0, length=1.0, height=0.03),
        measures.aggregate_fourth_power(1e5 + 0 * x, 1e5, x),
        passive_theory.variances(truck, "A", speeds),
        passive_theory.invariant_frequencies(truck), result,
        paper.PaperResults((result,), surface, surface),
        judged, Wrong("skyhook", "ADD", 0.01, 0.0), *order,
        ClassRow("skyhook", 1.1, 0.1, 1.2, 0.1), Ranking("class DAE", "all", *order),
        case, case.daf_peak, light, ValidationResults((road,), surface.speeds, (case,), light),
    ]  # fmt: skip


def test_every_class_shows_itself_in_one_line_with_units(things):
    for thing in things:
        text = repr(thing)
        assert text.startswith(f"{type(thing).__name__}("), text
        assert len(text) < 400, text
        assert not re.search(r"\n|array\(|\[\.\.\.\]| object at 0x", text), text
        assert QUANTITY.search(text) or isinstance(thing, DIMENSIONLESS_CLASSES), text
    classes = {offer.thing for offer in TOP.values() if offer.is_class and not offer.is_error}
    assert classes <= {type(thing) for thing in things}


def test_the_numbers_of_every_result_have_units_or_say_that_they_have_none(things):
    for result in {type(thing) for thing in things}:
        owners = [c for c in result.__mro__ if c.__module__.startswith("bridgectl")]
        told = {key: text for c in owners for key, text in Offer(c.__name__, c).told.items()}
        fields = {*getattr(result, "_fields", ()), *getattr(result, "__dataclass_fields__", ())}
        for owner in owners:
            for name, annotation in inspect.get_annotations(owner).items():
                if name in fields and NUMBERS.search(str(annotation)) and name[0] != "_":
                    assert _has_unit(told.get(name, "")), f"{owner.__name__}: {name}"


def test_a_crossing_and_a_damper_tell_every_parameter(bridge, truck):
    crossing = repr(bc.Crossing(bridge, truck, bc.TireForce()))
    assert repr(bridge) in crossing
    assert repr(truck) in crossing
    assert "TireForce(tire=1)" in crossing
    moment = bc.Moment(10.0, recovery="li2006", sense="smallest")
    assert "Moment(at=10 m, recovery='li2006', sense='smallest')" in repr(
        bc.Crossing(bridge, truck, moment)
    )
    assert repr(dampers.Damper(dampers.passive(7e3), max_force=15e3)) == (
        "Damper(Strategy('passive 7 kN s/m', c from 7000 to 7000 N s/m), sample_time=0.002 s, "
        "lag=0 s, max_force=15000 N, velocity_noise=0 m/s, seed=0, "
        "position_error=0 m, position_deviation=0 m, position_drift=0, speed_error=0, "
        "acceleration_noise=0 m/s^2, travel_noise=0 m, preview_noise=0 m, preview_delay=0 s)"
    )


def test_an_unknown_keyword_is_an_error_that_names_it(bridge, truck):
    with pytest.raises(TypeError, match="speeed"):
        bc.crossing_response(bridge, truck, speeed=30.0)


def test_the_package_is_typed():
    from importlib.resources import files

    assert files("bridgectl").joinpath("py.typed").is_file()


def test_tab_completion_lists_what_is_offered_and_nothing_else():
    assert set(dir(bc)) == {*bc.__all__, *bc._ROOMS, "__version__"}
    for name in bc._ROOMS:
        assert inspect.ismodule(getattr(bc, name))
    with pytest.raises(AttributeError, match="module 'bridgectl' has no attribute 'LAZY'"):
        _ = bc.LAZY


def test_nothing_is_loaded_before_it_is_used():
    program = "import sys, bridgectl; assert not {'numpy', 'control'} & sys.modules.keys()"
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.slow
def test_a_crossing_without_a_damper_does_not_load_casadi():
    program = (
        "import sys, bridgectl as b; beam, car = b.li2006.beam(), b.li2006.car(); "
        "b.daf(beam, car, 25.0); b.ramp_surface(beam, car, 25.0, ramp_length=5.0); "
        "b.crossing_response(beam, car, 25.0); assert 'casadi' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.slow
def test_every_module_is_found_by_its_name_loaded_or_not():
    program = (
        "import bridgectl as b; assert b.RampSurface is b.surface.surface.RampSurface; "
        "assert b.simulate.daf is b.daf and b.road.iri and not hasattr(b, 'absent')"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
