"""CITATION.cff: what it must have, and that it is of this version. Read as plain text."""

import re
from pathlib import Path

import pytest

import bridgectl as bc

FILE = Path(__file__).parents[1] / "CITATION.cff"


@pytest.fixture(scope="module")
def text():
    return FILE.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def top(text):
    """Keys at the first level."""
    return dict(re.findall(r"^([\w-]+): *(.*)$", text, re.MULTILINE))


def test_it_is_a_citation_file_of_this_version(top):
    assert {"message", "title", "authors", "references"} <= set(top)
    assert top["cff-version"] == "1.2.0"
    assert top["version"] == bc.__version__
    assert top["license"] == "BSD-3-Clause"


def test_every_line_is_a_key_or_an_entry_indented_by_twos(text):
    assert "\t" not in text
    for line in text.splitlines():
        indent, rest = re.fullmatch(r"( *)(.*?)", line).groups()
        assert len(indent) % 2 == 0, line
        assert re.match(r"(- )?[\w-]+:( |$)|- \w", rest), line
        value = rest.removeprefix("- ").partition(": ")[2]
        assert value.startswith('"') or ": " not in value, line


def test_it_names_both_papers(text):
    first, second = text.split("- type: article")[1:]
    for part, words in (
        (first, ["family-names: Li", "volume: 293", "year: 2006", "start: 125", "end: 137"]),
        (second, ["family-names: Harris", "volume: 302", "year: 2007", "start: 471", "end: 485"]),
    ):
        assert "journal: Journal of Sound and Vibration" in part
        assert all(word in part for word in words)
