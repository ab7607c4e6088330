"""Saved ramp surfaces come back to the bit, or are refused with one line."""

import dataclasses
import io
import json
import os
import random
import sys
import tracemalloc
import warnings
import zipfile

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.surface import load as surface_file
from bridgectl.surface.expected import SurfaceFileError
from bridgectl.surface.file import save_surface
from bridgectl.surface.histories import DenseHistories
from bridgectl.surface.labelled import surface_to_xarray
from bridgectl.surface.load import load_surface
from bridgectl.surface.parts import COMPUTED, UNITS

SPEEDS = np.array([70, 90, 110]) / 3.6
LEGS = np.array([[1, -1.5, -1, 0], [1, 2.5, 0, -1]])
HALF_CAR = bc.Vehicle(
    mass_matrix=np.diag([12000, 20000, 700, 900]),
    damping_matrix=1e4 * LEGS.T @ LEGS,
    stiffness_matrix=2e5 * LEGS.T @ LEGS,
    tire_stiffnesses=[1.8e6, 3.6e6],
    tire_offsets=[0, 4.0],
    damper_map=LEGS,
    heave=[1, 0, 1, 1],
    coordinates=["heave", "pitch", "front", "rear"],
)
STUDIES = {
    "paper": {"recovery": "li2006"},
    "approach": {"approach": 20.03, "section": 0.4},
    "half-car": {"vehicle": HALF_CAR, "approach": 5, "ramp_length": 0.25, "ramp_height": 2e-3},
    "two trucks": {"vehicle": bc.convoy([bc.li2006.car()] * 2, [0, 5])},
    "damped modes": {"beam": bc.Beam(25, 18358, 4.86535e10, damping_ratio=(0.01, 0.02, 0.1 / 3))},
    "dense": {"approach": 5.0, "ramp_length": 1.0},
}


def made(*, speeds=SPEEDS, **study):
    study = {"beam": bc.li2006.beam(), "vehicle": bc.li2006.car()} | study
    return bc.ramp_surface(speeds=speeds, **study)


def dense(surface):
    """The surface with its histories one by one, in memory as method='control' leaves them."""
    old, speeds = surface.histories, range(len(surface.speeds))
    unit = np.array([old.moments(speed, 1.0).T for speed in speeds])
    new = DenseHistories(old.nodes, old.smooth, np.moveaxis(unit, 1, 2))
    return dataclasses.replace(surface, histories=new)


@pytest.fixture(scope="module", params=STUDIES)
def surface(request):
    surface = made(**STUDIES[request.param])
    return dense(surface) if request.param == "dense" else surface


@pytest.fixture(scope="module")
def small():
    return made(speeds=[25.0, 30.0], ramp_length=5.0, recovery="li2006")


@pytest.fixture
def file(small, tmp_path):
    save_surface(small, tmp_path / "surface.npz")
    return tmp_path / "surface.npz"


def assert_equal(found, expected):
    """Assert that two surfaces, or parts of them, are one to the bit."""
    assert type(found) is type(expected)
    if dataclasses.is_dataclass(expected):
        for field in dataclasses.fields(expected):
            assert_equal(getattr(found, field.name), getattr(expected, field.name))
    elif isinstance(expected, np.ndarray):
        assert found.dtype == expected.dtype
        np.testing.assert_array_equal(found, expected, strict=True)
    else:
        assert found == expected


def loaded_or_refused(file, **expected):
    """Return the surface in a file, or else why it is refused: one line that names the file."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return load_surface(file, **expected), ""
        except SurfaceFileError as error:
            message = str(error)
            assert message.startswith(f"{file}: ")
            assert message.isprintable()
            assert len(message) < 2000
            return None, message.removeprefix(f"{file}: ")


def refused(file, **expected):
    """Return why a file is refused."""
    surface, message = loaded_or_refused(file, **expected)
    assert surface is None
    return message


def rewritten(file, change, *, summed=False):
    """Change arrays and header of a file by a function of both; the sum stays or is made anew."""
    with np.load(file) as saved:
        arrays = dict(saved)
    header = json.loads(str(arrays.pop("header")))
    change(header, arrays)
    if summed:
        header["checksum"] = surface_file.checksum(header, arrays)
    np.savez(file, header=np.array(json.dumps(header)), **arrays)


def test_a_loaded_surface_is_the_saved_one_to_the_bit(surface, tmp_path):
    save_surface(surface, tmp_path / "surface.npz")
    loaded = load_surface(tmp_path / "surface.npz")
    assert_equal(loaded, surface)
    assert repr(loaded) == repr(surface)


def test_a_loaded_surface_gives_the_results_of_the_saved_one_to_the_bit(surface, tmp_path):
    save_surface(surface, tmp_path / "surface.npz")
    loaded = load_surface(tmp_path / "surface.npz")
    road = rough_road(1, -30, 25)
    for result in ("dae", "superposed_daf", "contributions", "ramps"):
        found, expected = (getattr(each, result)(road) for each in (loaded, surface))
        np.testing.assert_array_equal(found, expected)
    for speed in range(len(SPEEDS)):
        for drop in (1e-3, -2e-3):
            found, expected = (each.histories.peaks(speed, drop) for each in (loaded, surface))
            np.testing.assert_array_equal(found, expected)
    assert not loaded.speeds.flags.writeable


def test_the_study_of_a_surface_is_found_in_its_file(surface, tmp_path):
    save_surface(surface, tmp_path / "surface.npz")
    names = [f.name for f in dataclasses.fields(surface) if f.name not in COMPUTED]
    load_surface(tmp_path / "surface.npz", **{name: getattr(surface, name) for name in names})


def test_a_file_tells_what_it_holds_without_bridgectl(surface, tmp_path):
    save_surface(surface, tmp_path / "surface.npz")
    with np.load(tmp_path / "surface.npz", allow_pickle=False) as saved:
        arrays = dict(saved)
    header = json.loads(str(arrays.pop("header")))
    assert (header["format"], header["version"]) == ("bridgectl ramp surface", 3)
    assert header["bridgectl"] == bc.__version__
    assert header["parameters"]["beam.length"] == 25.0
    assert header["units"]["beam.flexural_rigidity"] == "N m^2"
    assert header["arrays"].keys() == arrays.keys()
    for name, array in arrays.items():
        # A new array needs its unit in UNITS, and one of a surface or its histories AXES too.
        assert header["arrays"][name]["unit"] == UNITS[name], name
        if not name.startswith("vehicle."):
            assert len(header["arrays"][name]["axes"]) == array.ndim, name
    parts = {name for name in header["parameters"] if "." in name}
    assert parts - header["units"].keys() <= {
        "vehicle.coordinates",
        "vehicle.damper_names",
        "effect.recovery",
        "effect.sense",
    }


def test_a_new_field_of_a_surface_is_saved_without_further_ado(small, tmp_path, monkeypatch):
    fields = [
        ("colour", str),
        ("share", float, 0.5),
        ("axles", tuple, (1, "a")),
        ("level", np.ndarray),
        ("none", None, None),
        ("flag", bool, True),
    ]
    newer = dataclasses.make_dataclass(
        "RampSurface", fields, bases=(bc.RampSurface,), frozen=True, eq=False, kw_only=True
    )
    monkeypatch.setitem(surface_file._CLASSES, "RampSurface", newer)
    old = {f.name: getattr(small, f.name) for f in dataclasses.fields(bc.RampSurface)}
    path = tmp_path / "surface.npz"
    surface = newer(**old, colour="red", level=np.array(2.0), share=np.float64(0.1))
    save_surface(surface, path)
    assert_equal(
        load_surface(path, colour="red", share=0.1), dataclasses.replace(surface, share=0.1)
    )
    assert "colour is 'red' in the file, 'blue' expected" in refused(path, colour="blue")
    assert surface_to_xarray(surface).attrs["flag"] == 1

    rewritten(path, lambda header, arrays: header["parameters"].pop("share"), summed=True)
    assert load_surface(path).share == 0.5  # a file from before the field: its default
    rewritten(path, lambda header, arrays: header["parameters"].pop("colour"), summed=True)
    assert "lacks 'colour'" in refused(path)
    save_surface(surface, path)
    monkeypatch.setitem(surface_file._CLASSES, "RampSurface", bc.RampSurface)
    assert "has the unknown 'axles', 'colour', 'flag', 'level', 'none' and 1 more" in refused(path)


@pytest.mark.parametrize(
    ("expected", "says"),
    [
        (
            {"beam": bc.Beam(25, 18358, 4.86535e10, damping_ratio=0.01)},
            "beam.damping_ratio is 0.0 in the file, 0.01 expected",
        ),
        (
            {"beam": bc.Beam(25, 18000, 4.86535e10)},
            "beam.mass_per_length is 18358.0 kg/m in the file, 18000.0 kg/m expected",
        ),
        (
            {"beam": bc.Beam(25, 18358, 4.86535e10, damping_ratio=(0, 0, 0))},
            "beam.damping_ratio is 0.0 in the file, (0.0, 0.0, 0.0) expected",
        ),
        (
            {"vehicle": dataclasses.replace(bc.li2006.car(), damping=7e3 / 2)},
            "vehicle.damping is 7000.0 N s/m in the file, 3500.0 N s/m expected",
        ),
        (
            {"vehicle": HALF_CAR},
            "vehicle.mass_matrix is an array of 2 x 2 from 0 to 9000 kg in the file, "
            "an array of 4 x 4 from 0 to 20000 kg expected",
        ),
        (
            {"vehicle": dataclasses.replace(bc.li2006.car(), tire_stiffness=1e6).linear},
            "vehicle.tire_stiffnesses[0] is 1800000.0 N/m in the file, 1000000.0 N/m expected",
        ),
        ({"section": 0.25}, "section is 0.5 in the file, 0.25 expected"),
        ({"recovery": "exact"}, "recovery is 'li2006' in the file, 'exact' expected"),
        ({"approach": 100}, "approach is 0.0 m in the file, 100.0 m expected"),
        ({"speeds": [25.0, 31]}, "speeds[1] is 30.0 m/s in the file, 31.0 m/s expected"),
        (
            {"speeds": 20.0},
            "speeds is an array of 2 from 25 to 30 m/s in the file, "
            "an array of 1 from 20 to 20 m/s expected",
        ),
        ({"ramp_length": 0.1}, "ramp_length is 5.0 m in the file, 0.1 m expected"),
        ({"ramp_height": 1e-2}, "ramp_height is 0.001 m in the file, 0.01 m expected"),
    ],
)
def test_a_surface_of_another_study_is_refused_with_both_values(file, expected, says):
    message = refused(file, **expected)
    assert f"not the expected surface: {says}" in message
    assert "bridgectl.ramp_surface" in message
    assert message.endswith(f"leave out {next(iter(expected))}=")


def test_every_difference_is_named(file):
    message = refused(file, approach=5.0, section=0.25, speeds=[25.0, 30.0])
    assert "approach is 0.0 m in the file, 5.0 m expected; section is 0.5" in message or (
        "section is 0.5 in the file, 0.25 expected; approach is 0.0 m" in message
    )
    assert "speeds" not in message


def test_the_same_study_in_other_words_is_the_same(file, small):
    speeds = np.array([90.0, 108.0]) / 3.6 * (1 + 1e-15)
    loaded = load_surface(
        file, vehicle=bc.li2006.car().linear, speeds=speeds, section=np.array(0.5)
    )
    assert_equal(loaded, small)


@pytest.mark.parametrize(
    ("expected", "error", "says"),
    [
        ({"beam": 25.0}, TypeError, "beam must be a bridgectl.Beam, Bridge or ModalBridge, got"),
        ({"vehicle": "car"}, TypeError, "vehicle must be a bridgectl.Vehicle or QuarterCar, got"),
        ({"speeds": [-1.0]}, ValueError, "speeds must be above 0 m/s"),
        ({"section": 2}, ValueError, "section must lie between 0 and 1"),
        ({"recovery": "best"}, ValueError, "recovery must be one of"),
        ({"approach": "long"}, TypeError, "approach must be one number [m]"),
        ({"spead": 1.0}, TypeError, "no parameter 'spead': expected parameters of the surface are"),
        ({"daf_unit": 1.0}, TypeError, "load_surface has no parameter 'daf_unit'"),
    ],
)
def test_an_expectation_that_is_none_is_named(file, expected, error, says):
    with pytest.raises(error) as caught:
        load_surface(file, **expected)
    assert says in str(caught.value)
    assert not isinstance(caught.value, SurfaceFileError)


def test_files_that_are_no_surface_are_refused(file, tmp_path):
    assert "no such file" in refused(tmp_path / "none.npz")
    assert "no file but a folder" in refused(tmp_path)
    other = tmp_path / "other"
    for content in (b"", b"x [m]\n0 1\n", b"PK\x03\x04", file.read_bytes()[:-30]):
        other.write_bytes(content)
        assert refused(other).startswith("no NPZ file, or cut short")
    np.savez(other.with_suffix(".npz"), x=np.zeros(3))
    assert "it has no 'header'" in refused(other.with_suffix(".npz"))
    np.save(other.with_suffix(".npy"), np.zeros(3))
    assert "no NPZ file" in refused(other.with_suffix(".npy"))
    with pytest.raises(SurfaceFileError, match="cannot be opened"):
        load_surface("sur\0face.npz")


def test_pickles_are_never_loaded(file, tmp_path):
    class Trap:
        def __reduce__(self):
            return (os.mkdir, (str(tmp_path / "trapped"),))

    for name in ("header", "daf_unit"):
        with np.load(file) as saved:
            arrays = dict(saved) | {name: np.array([Trap()], dtype=object)}
        np.savez(tmp_path / "trap.npz", **arrays)
        assert f"'{name}' cannot be read (Object arrays" in refused(tmp_path / "trap.npz")
    assert not (tmp_path / "trapped").exists()


def changed(name, change):
    return lambda header, arrays: arrays.update({name: change(arrays[name])})


def parameter(name, value):
    return lambda header, arrays: header["parameters"].update({name: value})


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda h, a: h.update(version=1), "has version 1 of the format, by bridgectl 0"),
        (lambda h, a: h.pop("checksum"), "no valid surface, or damaged (KeyError: 'checksum')"),
        (lambda h, a: h.update(format="roads"), "its 'header' does not say 'bridgectl ramp surf"),
        (lambda h, a: h.pop("parameters"), "damaged (KeyError: 'parameters')"),
        (lambda h, a: h.update(parameters=[1]), "no valid surface, or damaged (TypeError"),
        (lambda h, a: h.update(classes={}), "no valid surface, or damaged (KeyError"),
        (lambda h, a: h["classes"].update(beam="Truss"), "beam is a Truss"),
        (lambda h, a: h["classes"].update(histories="Beam"), "lacks 'histories.length'"),
        (lambda h, a: h["classes"].update(beam="QuarterCar"), "lacks 'beam.sprung_mass'"),
        (lambda h, a: h["arrays"]["daf_unit"].pop("memory_order"), "KeyError: 'memory_order'"),
        (lambda h, a: a.pop("daf_unit"), "lacks 'daf_unit'"),
        (lambda h, a: a.update(more=np.zeros(1)), "has 'more', which its 'header' does not name"),
        (lambda h, a: h["parameters"].pop("approach"), "lacks 'approach'"),
        (parameter("colour", "red"), "has the unknown 'colour': this file, by bridgectl"),
        (parameter("effect.at", "mid"), "at must be one number"),
        (parameter("effect.recovery", "best"), "recovery must be one of 'exact'"),
        (parameter("beam.length", -25.0), "length must be above 0 [m]"),
        (parameter("beam.length", 50.0), "'positions' are not those of 10 ramps"),
        (parameter("ramp_length", 4.9), "'positions' are not those of 6 ramps"),
        (parameter("ramp_height", None), "ramp_height must be one number [m]"),
        (parameter("vehicle.damping", float("nan")), "damping must be finite"),
        (changed("speeds", lambda a: -a), "speeds must be above 0 m/s"),
        (changed("daf_unit", lambda a: a[:, :-1]), "'daf_unit' has shape (2, 4), expected (speed"),
        (changed("daf_unit", lambda a: a[0]), "'daf_unit' has shape (5,), expected 2 axes"),
        (changed("daf_smooth", lambda a: a * np.nan), "'daf_smooth' has numbers that are not fini"),
        (changed("positions", lambda a: a + 1), "'positions' are not those of 5 ramps"),
        (changed("positions", lambda a: a.astype("f4")), "'positions' holds float32, expected"),
        (changed("histories.local", lambda a: a + 9), "names a ramp beyond the 5"),
        (changed("histories.local", lambda a: a * 1.0), "'histories.local' holds float64"),
        (changed("histories.nodes", lambda a: a[1:]), "samples do not fit"),
        (changed("histories.rows", lambda a: a[:, :, 1:]), "expected (speed: 2, block: "),
        (changed("histories.carried", lambda a: a[..., 1:]), "'histories.carried' has shape"),
    ],
)
def test_a_surface_that_does_not_fit_is_refused(file, change, says):
    rewritten(file, change)
    assert says in refused(file)


@pytest.mark.parametrize(
    "change",
    [
        parameter("effect.at", 11.25),
        parameter("effect.recovery", "exact"),
        parameter("ramp_height", 2e-3),
        parameter("beam.length", np.nextafter(25.0, 0)),
        parameter("beam.n_modes", 2),
        parameter("beam.damping_ratio", 0.01),
        parameter("beam.flexural_rigidity", 4.86535e9),
        parameter("vehicle.damping", 12e3),
        changed("speeds", lambda a: a + 1e-9),
        changed("daf_smooth", lambda a: np.where(a == a[0], np.nextafter(a, 9), a)),
        changed("histories.rows", lambda a: -a),
        lambda h, a: h.update(bridgectl="0.0.9"),
        lambda h, a: h.update(checksum=h["checksum"][::-1]),
    ],
)
def test_a_surface_that_was_edited_is_refused_even_if_it_fits(file, change):
    rewritten(file, change)
    assert refused(file).startswith("damaged: its numbers are not those that were saved, or edit")


def test_a_header_that_says_the_same_in_another_layout_is_the_same(file, small):
    with np.load(file) as saved:
        arrays = dict(saved)
    header = json.loads(str(arrays.pop("header")))
    laid_out = json.dumps(dict(reversed(header.items())), indent=4)
    np.savez(file, header=np.array(laid_out), **arrays)
    assert_equal(load_surface(file), small)


def test_too_few_samples_in_a_block_are_noticed(file):
    def shorten(header, arrays):
        for name in ("histories.rows", "histories.direct"):
            arrays[name] = arrays[name][:, :, :2]

    rewritten(file, shorten)
    assert "blocks do not hold" in refused(file)


def mutated(data, rng):
    """Return data after one flip, deletion, insertion, cut or overwriting."""
    i, kind = rng.randrange(len(data)), rng.randrange(5)
    if rng.random() < 0.5:  # the directory, names and headers are few of the bytes
        marks = [data.find(mark, i) for mark in (b"PK", b"NUMPY", b".npy", b"{")]
        i = min(max(i, *marks) + rng.randrange(40), len(data) - 1)
    if kind == 0:
        return data[:i] + bytes([data[i] ^ 1 << rng.randrange(8)]) + data[i + 1 :]
    if kind == 1:
        return data[:i] + data[i + rng.randrange(1, 20) :]
    if kind == 2:
        return data[:i] + rng.randbytes(rng.randrange(1, 20)) + data[i:]
    if kind == 3:
        return data[:i]
    junk = rng.choice([b"\0" * 8, b"\xff" * 8, rng.randbytes(4), b"PK\x05\x06"])
    return data[:i] + junk + data[i + len(junk) :]


MANY = pytest.mark.parametrize(
    ("seed", "count"), [(0, 300), pytest.param(1, 2500, marks=pytest.mark.slow)]
)


@MANY
def test_a_damaged_file_is_read_as_it_was_or_refused_with_one_line(file, small, seed, count):
    data, rng, read = file.read_bytes(), random.Random(seed), 0
    for _ in range(count):
        file.write_bytes(mutated(data, rng))
        surface, _message = loaded_or_refused(file)
        if surface:  # what changed was a time stamp, say
            read += 1
            assert_equal(surface, small)
    assert 2 < read < count / 2  # else the damage is of one kind


@pytest.mark.slow
@MANY
def test_a_damaged_header_is_refused_with_one_line(file, small, seed, count):
    """The zip archive's own sum of bytes is right: what it says is not."""
    with np.load(file) as saved:
        arrays = dict(saved)
    text, rng, read = str(arrays.pop("header")), random.Random(seed), 0
    words = ["null", "{}", "[]", '""', "-1", "NaN", "1e999", "0", '"beam"', "true", "[[", "\0"]
    places = [i for i, c in enumerate(text, start=1) if c in ':,"']
    for _ in range(count):
        i = rng.choice(places)
        if rng.random() < 0.5:
            digits = [j for j, c in enumerate(text) if c.isdigit()]
            j = rng.choice(digits)
            damaged = text[:j] + rng.choice("0123456789") + text[j + 1 :]
        else:
            damaged = text[:i] + rng.choice(words) + text[i + rng.choice([0, 1, 8]) :]
        np.savez(file, header=np.array(damaged), **arrays)
        surface, _message = loaded_or_refused(file)
        if surface:  # a digit became itself
            read += 1
            assert_equal(surface, small)
    assert read < count / 4


def test_a_header_of_another_version_of_numpys_format_is_refused(file):
    with_member(file, "daf_unit.npy", npy((2, 5)).replace(b"\1\0", b"\2\0", 1) + bytes(80))
    assert "its header is none of NumPy's first version" in refused(file)


# Files that fill the memory


def peak_memory(function):
    """Return the largest memory that a function takes [bytes], and what it returns."""
    tracemalloc.start()
    try:
        result = function()
        return tracemalloc.get_traced_memory()[1], result
    finally:
        tracemalloc.stop()


def npy(shape):
    """Return what NumPy writes before the numbers of an array."""
    head = io.BytesIO()
    description = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(head, description)
    return head.getvalue()


def with_member(file, name, content, how=zipfile.ZIP_DEFLATED, **lies):
    """Put another array into a file, of which its directory may tell lies."""
    with zipfile.ZipFile(file) as old:
        others = {member: old.read(member) for member in old.namelist() if member != name}
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as new:
        for member, data in others.items():
            new.writestr(member, data)
        new.writestr(name, content, how)
        for field, value in lies.items():
            setattr(new.filelist[-1], field, value)


MANY_ZEROS = 8 * 2 * 5_000_000
"""80 MB that pack into 80 kB."""


@pytest.mark.quick_cases(3)
@pytest.mark.parametrize(
    ("shape", "zeros", "options", "says"),
    [
        ((2, 5_000_000), MANY_ZEROS, {}, "bytes, and would inflate to 80"),
        ((2, 5), MANY_ZEROS, {}, "bytes, and would inflate to 80"),
        ((2, 5), MANY_ZEROS, {"file_size": 208}, "cannot be read (BadZipFile: Bad CRC-32"),
        ((2, 5_000_000), MANY_ZEROS, {"file_size": 208}, "cannot be read (BadZipFile: Bad CRC-3"),
        ((2, 5), MANY_ZEROS, {"how": zipfile.ZIP_BZIP2}, "'daf_unit.npy' is packed in another wa"),
        ((2, 5), MANY_ZEROS, {"how": zipfile.ZIP_LZMA, "file_size": 208}, "is packed in another"),
        ((2, 10**15), 80, {}, "(shape (2, 1000000000000000) of float64 does not make"),
        ((-2, -5), 79, {}, "does not make its"),
        ((2, 5), 88, {}, "(shape (2, 5) of float64 does not make its 216 bytes"),
    ],
)
def test_a_file_that_fills_the_memory_is_refused_before_it_does(file, shape, zeros, options, says):
    with_member(file, "daf_unit.npy", npy(shape) + bytes(zeros), **options)
    assert file.stat().st_size < 1e6
    peak, message = peak_memory(lambda: refused(file))
    assert says in message
    assert peak < 20e6  # [bytes]; the arrays would be 80e6


def test_a_header_of_too_many_brackets_is_refused(file):
    np.savez(file, header=np.array("[" * 100_000))
    assert "no valid surface, or damaged (RecursionError" in refused(file)


def test_a_file_that_python_zips_anew_and_compressed_is_the_same(file, small, tmp_path):
    packed = tmp_path / "packed.npz"
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as new:
        for name in reversed(old.namelist()):
            new.writestr(name, old.read(name))
    assert_equal(load_surface(packed), small)


def test_a_path_without_npz_is_refused(small, tmp_path):
    for name in ("surface", "surface.csv", "surface.npz.bak"):
        with pytest.raises(ValueError, match=r"path must end in \.npz, got .*type path='surf"):
            save_surface(small, tmp_path / name)
    assert not list(tmp_path.iterdir())
    save_surface(small, str(tmp_path / "SURFACE.NPZ"))


def test_only_surfaces_of_known_parts_are_saved(small, tmp_path):
    class Truss(bc.Beam):
        pass

    path = tmp_path / "surface.npz"
    with pytest.raises(TypeError, match=r"surface must be a bridgectl\.RampSurface, got ndarray"):
        save_surface(small.daf_unit, path)
    truss = Truss(25, 18358, 4.86535e10)
    with pytest.raises(TypeError, match="beam is a Truss, which files do not hold"):
        save_surface(dataclasses.replace(small, beam=truss), path)
    with pytest.raises(TypeError, match="approach is a complex, which files do not hold"):
        save_surface(dataclasses.replace(small, approach=1j), path)
    assert not list(tmp_path.iterdir())


def test_a_file_stays_as_it_is_when_saving_fails(small, file, monkeypatch):
    before = file.read_bytes()

    def full(handle, **arrays):
        handle.write(b"PK")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(OSError, match="No space left on device") as caught:
        save_surface(small, file)
    assert caught.value.filename == str(file)
    assert file.read_bytes() == before
    assert os.listdir(file.parent) == [file.name]


def test_saving_into_no_folder_is_an_error_that_names_the_file(small, tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        save_surface(small, tmp_path / "none" / "surface.npz")
    assert caught.value.filename == str(tmp_path / "none" / "surface.npz")


def test_saving_replaces_a_file_and_keeps_its_mode_and_links(small, file, tmp_path):
    file.chmod(0o640)
    link = tmp_path / "link.npz"
    link.symlink_to(file)
    save_surface(made(speeds=20.0, ramp_length=5.0), link)
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o640
    assert load_surface(file).speeds.tolist() == [20.0]


def test_a_dataset_has_the_surface_with_labels(surface):
    pytest.importorskip("xarray")
    data = surface_to_xarray(surface)
    assert data.daf_unit.dims == data.daf_difference.dims == ("speed", "position")
    for name in ("daf_smooth", "daf_unit", "daf_difference"):
        np.testing.assert_array_equal(data[name], getattr(surface, name))
    assert data.speed_kmh.values == pytest.approx([70, 90, 110])
    assert data.x_over_l.values == pytest.approx(surface.positions / 25)
    for array in (*data.data_vars.values(), *data.coords.values()):
        assert array.attrs.keys() == {"units", "long_name"}
    at_90 = data.daf_unit.sel(speed=25.0, position=0.0, method="nearest")
    assert at_90 == surface.daf_unit[1, np.argmin(np.abs(surface.positions))]
    assert data.attrs["beam_flexural_rigidity"] == 4.86535e10
    assert data.attrs["beam_flexural_rigidity_units"] == "N m^2"
    assert data.attrs["effect_recovery"] == surface.recovery
    assert data.attrs["vehicle"] == type(surface.vehicle).__name__


def test_a_dataset_can_be_written_as_netcdf(surface, tmp_path):
    xarray = pytest.importorskip("xarray")
    data = surface_to_xarray(surface)
    data.to_netcdf(tmp_path / "surface.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "surface.nc", engine="scipy") as read:
        xarray.testing.assert_equal(read.load(), data)
        assert read.attrs["ramp_length"] == surface.ramp_length


def test_without_xarray_the_error_says_what_to_type(small, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError) as caught:
        surface_to_xarray(small)
    assert str(caught.value).endswith('type pip install "bridgectl[xarray]"')
