"""Files of scores in progress: what they hold is what was written, or it is done again."""

import json
import os
import random
import resource
import subprocess
import sys
import warnings
from functools import partial

import numpy as np
import pytest

import bridgectl
from bridgectl import _parts
from bridgectl.scoring.run import KIND

Parts = partial(_parts.Parts, kind=KIND)

SHAPES = {"daf": (2, 3), "daf_smooth": (3,)}
NAMES = ("passive", "skyhook", "bridgehook", "Größe")
ASKED = {(name, f"{i}a"): SHAPES for i, name in enumerate(NAMES)}
STUDY = {"beam": {"length": 25.0}, "speeds": [20.0, 25.0, 30.0]}
OTHER = {**STUDY, "beam": {"length": 15.0}}


def computed(name, study=STUDY):
    """The numbers of a part; no two parts or studies share one."""
    rng = np.random.default_rng([*name.encode(), int(study["beam"]["length"])])
    return {measure: rng.normal(1, 0.1, shape) for measure, shape in SHAPES.items()}


def resumed(file, study=STUDY, asked=ASKED, at_most=9):
    """Go on with a study; return its parts, and the names of those that were done."""
    done = []
    with Parts(file, study, asked) as parts:
        for name, key in asked:
            if (name, key) not in parts and len(done) < at_most:
                parts.keep(name, key, computed(name, study))
                done.append(name)
        return dict(parts.found), done


def assert_right(parts, study=STUDY):
    for (name, _), part in parts.items():
        expected = computed(name, study)
        assert part.keys() == expected.keys()
        for measure, values in part.items():
            np.testing.assert_array_equal(values, expected[measure], strict=True)


@pytest.fixture
def file(tmp_path):
    resumed(tmp_path / "score.jsonl")
    return tmp_path / "score.jsonl"


def lines(file):
    return file.read_bytes().splitlines(keepends=True)


def warned(file):
    """Resume a file; return the one warning, without the file's name, and what was done."""
    with pytest.warns(UserWarning, match="damaged and not used") as told:
        parts, done = resumed(file)
    assert_right(parts)
    assert len(parts) == len(ASKED)
    (warning,) = told
    assert str(file) in str(warning.message)
    return str(warning.message).replace(str(file), "FILE"), done


def refused(file, **options):
    """Return why a file is refused, which stays as it is."""
    before = file.read_bytes()
    with pytest.raises(ValueError, match=r"\A[ -~]+\Z") as caught:
        resumed(file, **options)
    assert file.read_bytes() == before
    assert str(file) in str(caught.value)
    return str(caught.value).replace(str(file), "FILE")


def test_what_a_file_holds_is_read_to_the_bit(file):
    parts, done = resumed(file)
    assert not done
    assert len(parts) == len(ASKED)
    assert_right(parts)
    for line in lines(file):
        assert json.loads(line).keys() >= {"check"}


# Damage


@pytest.mark.parametrize(
    "edit",
    [
        lambda line: line.replace(b"1.", b"0.", 1),
        lambda line: line.replace(b"[[", b"[[NaN, ", 1),
        lambda line: line[:60] + line[61:],
        lambda line: line.replace(b'"daf"', b'"daf_"'),
        lambda line: line.replace(b'"skyhook"', b'"passive"'),
        lambda line: line.replace(b'"check"', b'"chick"'),
        lambda line: json.dumps(dict(reversed(json.loads(line).items()))).encode() + b"\n",
        lambda line: b"\xff\xfe\0[[[\n",
        lambda line: b"[" * 100_000 + b"\n",
    ],
)
def test_a_damaged_line_is_named_and_done_again_and_the_others_are_kept(file, edit):
    header, passive, skyhook, *others = lines(file)
    file.write_bytes(b"".join([header, passive, edit(skyhook), *others]))
    message, done = warned(file)
    assert (
        message == "line 3 of FILE is damaged and not used: what no other line holds is done again"
    )
    assert done == ["skyhook"]
    assert warned(file)[1] == []  # its part is at the end now


def test_the_warning_lists_five_lines(file):
    file.write_bytes(lines(file)[0] + 7 * b"?\n")
    assert warned(file)[0].startswith("lines 2, 3, 4, 5, 6, ... of FILE are damaged and not used")


def test_without_its_first_line_a_file_still_holds_its_parts(file):
    first, *others = lines(file)
    file.write_bytes(b"".join(others))
    assert resumed(file)[1] == []
    file.write_bytes(b"".join([first.replace(b"25.0", b"35.0"), *others]))
    message, done = warned(file)
    assert message.startswith("line 1 of FILE is damaged")
    assert done == []


def test_a_first_line_made_to_fit_another_study_does_not_bring_its_parts(file):
    first, *others = lines(file)
    file.write_bytes(b"".join([first.replace(b"25.0", b"15.0", 1), *others]))
    message = refused(file, study=OTHER)
    assert message.startswith("line 1 of FILE is damaged, or it is no file of a score: type")


@pytest.mark.parametrize("cut", [1, 3, 20, 60, 1000])
def test_a_last_line_that_was_cut_short_is_done_again_without_a_word(file, cut):
    whole = file.read_bytes()
    last = len(lines(file)[-1])
    file.write_bytes(whole[: -min(cut, last - 1)])
    parts, done = resumed(file)
    assert_right(parts)
    assert done == ([] if cut == 1 else [NAMES[-1]])  # only the end of the line was missing
    assert file.read_bytes() == whole


@pytest.mark.parametrize("size", [0, 1, 5, 30, 90, 150])
def test_a_first_line_that_was_cut_short_is_written_anew(file, size):
    whole = file.read_bytes()
    file.write_bytes(whole[:size])
    assert len(lines(file)) <= 1
    assert resumed(file)[1] == list(NAMES)
    assert file.read_bytes() == whole


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(b"\n", b"\r\n"),
        lambda text: text.replace(b"\n", b"\n\n \n"),
        lambda text: b"\n\n" + text,
        lambda text: text + text,
        lambda text: text + text.split(b"\n", 1)[1],
        lambda text: b"\n".join(reversed(text.split(b"\n"))) + b"\n",
        lambda text: text + b"   ",
    ],
)
def test_the_same_lines_laid_out_otherwise_are_the_same(file, change):
    file.write_bytes(change(file.read_bytes()))
    parts, done = resumed(file)
    assert not done
    assert_right(parts)


def test_a_byte_order_mark_costs_a_warning(file):
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert warned(file) == (
        "line 1 of FILE is damaged and not used: what no other line holds is done again", [],
    )  # fmt: skip
    file.write_bytes(file.read_bytes().decode("utf-8-sig").encode("utf-16"))
    assert refused(file).startswith("line 1 of FILE is damaged, or it is no file of a score")


def test_parts_with_a_right_sum_must_have_the_right_arrays(file):
    first = lines(file)[0].strip()
    good = {measure: values.tolist() for measure, values in computed("skyhook").items()}
    for wrong in (
        {**good, "daf": good["daf_smooth"]},
        {**good, "daf": [[1.0, 2.0, float("inf")], [1.0, 2.0, 3.0]]},
        {**good, "daf": [[1.0], [1.0, 2.0]]},
        {**good, "daf": "high"},
        {**good, "dae": good["daf"]},
        {"daf": good["daf"]},
    ):
        line = _parts._line({"part": "skyhook", "key": "1a", **wrong}, first)
        file.write_bytes(first + b"\n" + line + b"\n")
        message, done = warned(file)
        assert message.startswith("line 2 of FILE is damaged")
        assert done == list(NAMES)


def test_numbers_that_are_not_finite_are_not_kept(tmp_path):
    part = {**computed("passive"), "daf_smooth": np.array([1.0, np.nan, 1.0])}
    with Parts(tmp_path / "score.jsonl", STUDY, ASKED) as parts:
        parts.keep("passive", "0a", part)
        assert parts["passive", "0a"] is part
    assert resumed(tmp_path / "score.jsonl")[1] == list(NAMES)


# Other studies and versions


def test_lines_of_another_study_in_a_file_are_refused(file, tmp_path):
    resumed(tmp_path / "other", study=OTHER)
    file.write_bytes(file.read_bytes() + (tmp_path / "other").read_bytes())
    assert refused(file) == (
        "line 6 of FILE holds another study: its beam is {'length': 15.0}, "
        "not {'length': 25.0}; type the name of a new file"
    )
    # Its parts alone have the wrong sum, for they have the same names and keys.
    file.write_bytes(b"".join(lines(file)[:2] + lines(tmp_path / "other")[2:]))
    assert warned(file)[1] == list(NAMES[1:])


def test_parts_by_another_version_are_not_mixed_in(file, monkeypatch):
    monkeypatch.setattr(bridgectl._version, "__version__", "9.9")
    assert refused(file) == (
        "FILE is by bridgectl 0.1.0, not 9.9, and parts of two versions are not mixed: type the "
        "name of a new file, or install bridgectl==0.1.0 to go on"
    )
    parts = lines(file)[1:]
    resumed(file.with_name("new"), at_most=0)
    file.write_bytes(file.with_name("new").read_bytes() + b"".join(parts))
    assert warned(file)[1] == list(NAMES)


def test_a_file_of_the_first_format_is_refused(file):
    header = {"format": "bridgectl score", "version": 1, **STUDY, "bridgectl": "0.1.0"}
    file.write_text(json.dumps(header) + '\n{"part": "passive", "key": "0a"}\n', encoding="utf-8")
    assert refused(file) == (
        "FILE holds another study: its version is 1 of the format, not 4; type the name of a new "
        "file"
    )


def test_more_strategies_go_into_one_file_and_stay_there(file):
    more = {("ADD", "9"): SHAPES}
    assert resumed(file, asked=more)[1] == ["ADD"]
    assert resumed(file)[1] == []
    assert resumed(file, asked=more)[1] == []


# Files that are none, and disks that are full


def test_a_pipe_or_device_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    for path in (tmp_path / "pipe", tmp_path / "zero", tmp_path):
        with pytest.raises(ValueError, match=f"{path} is no file but a folder, pipe or device"):
            resumed(path)


def test_a_line_without_end_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(_parts, "LONGEST", 2**12)
    (tmp_path / "zeros").write_bytes(bytes(2**13))
    assert "FILE is no file of a score, for none has lines of" in refused(tmp_path / "zeros")


def test_two_processes_do_not_write_one_file(file):
    with Parts(file, STUDY, ASKED):
        assert refused(file).startswith("FILE is in use by another score: wait for its end")
    assert resumed(file)[1] == []


def test_where_files_cannot_be_locked_they_are_written_without(file, monkeypatch):
    def fails(*_):
        raise OSError(37, "No locks available")

    monkeypatch.setattr(_parts.fcntl, "flock", fails)
    assert resumed(file)[1] == []


@pytest.mark.parametrize("room", [0, 1, 100, 400])
def test_a_full_disk_is_an_error_of_the_file_and_costs_no_part(file, room):
    """A limit on the size of files stands for the disk: writing stops in the middle of a line."""
    kept = lines(file)[:3]
    file.write_bytes(b"".join(kept))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (file.stat().st_size + room, hard))
    try:
        with pytest.raises(OSError, match="File too large") as caught:
            resumed(file)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert caught.value.filename == str(file)
    assert lines(file)[:3] == kept
    parts, done = resumed(file)
    assert_right(parts)
    assert done == list(NAMES[2 if room < 400 else 3 :])


@pytest.mark.slow
def test_a_process_that_is_killed_while_it_writes_costs_one_part(tmp_path):
    program = (
        "import itertools, numpy as np\n"
        "from bridgectl._parts import Parts\n"
        "from bridgectl.scoring.run import KIND\n"
        "asked = {(str(i), ''): {'daf': (50, 99)} for i in range(10_000)}\n"
        f"with Parts({str(tmp_path / 'score.jsonl')!r}, {STUDY!r}, asked, KIND) as parts:\n"
        "    for i in range(10_000):\n"
        "        parts.keep(str(i), '', {'daf': np.full((50, 99), i / 3)})\n"
        "        print(i, flush=True)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    with process:
        told = [process.stdout.readline() for _ in range(20)]
        process.kill()
    assert told[-1] == "19\n"
    asked = {(str(i), ""): {"daf": (50, 99)} for i in range(20)}
    with Parts(tmp_path / "score.jsonl", STUDY, asked) as parts:
        for i in range(20):
            assert (parts[str(i), ""]["daf"] == i / 3).all()


# Mutations


def mutated(text, other, rng):
    """Return a file's bytes after one change of a kind that happens to files, or that people do."""
    found = text.splitlines(keepends=True) or [b""]
    i, j = rng.randrange(len(found)), rng.randrange(len(found))
    at, kind = rng.randrange(len(text) + 1), rng.randrange(12)
    if kind == 0 and at < len(text):
        return text[:at] + bytes([text[at] ^ 1 << rng.randrange(8)]) + text[at + 1 :]
    if kind == 1:
        return text[:at] + text[at + rng.choice([1, 1, 20, 400]) :]
    if kind == 2:
        found[i], found[j] = found[j], found[i]
    if kind == 3:
        found.insert(j, found[i])
    if kind == 4:
        return text[:at]
    if kind == 5:
        digits = [k for k, byte in enumerate(text) if chr(byte).isdigit()] or [0]
        k = rng.choice(digits)
        return text[:k] + rng.choice(b"0123456789").to_bytes() + text[k + 1 :]
    if kind == 6:
        words = [b"NaN", b"1e999", b"null", b"\n", b"\0", b"{", b"[", b"-", b"\r\n", b"\xff", b'"']
        return text[:at] + rng.choice(words) + text[at + rng.choice([0, 0, 1, 5]) :]
    if kind == 7:
        found.insert(j, rng.choice(other))
    if kind == 8:
        del found[i]
    if kind == 9:
        return text.replace(b"\n", rng.choice([b"\r\n", b"\n\n", b"\r", b""]))
    if kind == 10:
        return text[:at] + text[at:].replace(
            *rng.choice([(b"1.", b"0."), (b", ", b","), (b"passive", b"skyhook")]), 1
        )
    if kind == 11:
        return text[:at] + bytes(rng.choice([1, 64])) + text[at + 64 :]
    return b"".join(found)


@pytest.mark.parametrize(
    ("seed", "count"), [(0, 400), pytest.param(1, 5000, marks=pytest.mark.slow)]
)
def test_a_mutated_file_gives_the_same_numbers_or_one_line(
    file, tmp_path, seed, count, monkeypatch
):
    monkeypatch.setattr(os, "fsync", lambda _: None)
    resumed(tmp_path / "other", study=OTHER)
    text, other, rng = file.read_bytes(), lines(tmp_path / "other"), random.Random(seed)
    outcomes = {"silent": 0, "redone": 0, "warned": 0, "refused": 0}
    for _ in range(count):
        damaged = text
        for _ in range(rng.choice([1, 1, 1, 2, 5])):
            damaged = mutated(damaged, other, rng)
        file.write_bytes(damaged)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            try:
                parts, done = resumed(file)
            except ValueError as error:
                message = str(error)
                assert str(file) in message
                assert message.isprintable()
                assert file.read_bytes() == damaged
                outcomes["refused"] += 1
                continue
            assert len(parts) == len(ASKED)
            assert_right(parts)
            assert all(f"of {file} " in str(warning.message) for warning in told)
            outcomes["warned" if told else "redone" if done else "silent"] += 1
            again, more = resumed(file)
            assert not more
            assert_right(again)
    assert min(outcomes.values()) > count / 50, outcomes  # else the damage is of one kind
