"""Law: whatever is done to a design file, it either loads, all of it finite, or is refused with a place.

Shipped designs are damaged at random, as editors, transfers and people damage files. The first files of the long run are
those of the quick one.
"""

import dataclasses
import math
import random
import re
import time

import pytest

from spheredrive.design import Design
from spheredrive.designs import design_path, shipped_designs
from spheredrive.errors import InputError
from spheredrive.io.design_file import load_design, parse_design
from spheredrive.io.template import starting_file

SEED = 20261122
SLOWEST = 2.0  # s
NUMBER = re.compile(rb"[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?")
WORD = re.compile(rb"[A-Za-z_][A-Za-z_-]*")
NUMBERS = "0 -0.0 -1 1 3 1e-20 1e-15 1e14 1e15 1e16 1e308 1e999 5e-324 nan -inf inf 1_000 0x1F 07 1. .5 9999999999999999999 "
NUMBERS += '25,4 1,000.5 +5 --5 \N{ARABIC-INDIC DIGIT THREE} true "" [] {} 1979-05-27 1979-05-27T07:32:00Z'
UNITS = "mm|cm|m|km|MM|Mm|in|ft|kg|g|lb|s|ms|min|deg|rad|turn|rpm|Hz|rad/s|N|N/m|N*s/m|N m|Nm|J|kg m^2|Pa|GPa|%|degC|°|µm"
UNITS += "|m**9**9**9|m^-9|N/m/s|m m m m m m m m m||os.system('true')|€|__class__|m\\u0000|1|e5"
TEXTS = "é|\u202e|🛞|\u00a0|\u2028|\ufeff|\x1b[31m|\0|\r|\t|\"\"\"|'''|\\|\\u12|#|]]"
TABLES = "[sphere] [wheels.omni] [wheels] [[wheels]] [[placement]] [placement] [contact] [x.y.z] [[stage]]"
LINES = [
    'file = "wheel.csv"',
    'file = "/"',
    'catalogue = "sunfounder/zeus-60mm-mecanum"',
    'catalogue = "x"',
    'type = "measured"',
    'type = "triple-race"',
    "count = 1000",
    "contact = [0, 0, 1]",
    "drive = [1e-9, 0, 1e-9]",
    "inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
    "inertia = [1, [1], 1]",
    "springs = [{ direction = [1, 1, 1], stiffness = 1 }, {}]",
    "centre_of_mass = [0.01, 0, 0]",
    "a.b.c.d = 1",
]


def flip_byte(data, rng):
    i = rng.randrange(len(data))
    return data[:i] + bytes([data[i] ^ 1 << rng.randrange(8)]) + data[i + 1 :]


def delete_span(data, rng):
    i = rng.randrange(len(data))
    return data[:i] + data[i + rng.randint(1, 20) :]


def repeat_span(data, rng):
    i = rng.randrange(len(data))
    j = i + rng.randint(1, 60)
    return data[:j] + data[i:j] * rng.choice([1, 1, 1, 50]) + data[j:]


def truncate(data, rng):
    return data[: rng.randrange(len(data))]


def delete_line(data, rng):
    lines = data.split(b"\n")
    del lines[rng.randrange(len(lines))]
    return b"\n".join(lines)


def repeat_line(data, rng):
    lines = data.split(b"\n")
    lines.insert(rng.randrange(len(lines)), rng.choice(lines))
    return b"\n".join(lines)


def swap_lines(data, rng):
    lines = data.split(b"\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def insert_line(data, rng):
    lines = data.split(b"\n")
    lines.insert(rng.randrange(len(lines) + 1), rng.choice(LINES + TABLES.split()).encode())
    return b"\n".join(lines)


def uncomment(data, rng):
    found = list(re.finditer(rb"^# ", data, re.MULTILINE))
    at = rng.choice(found).start() if found else 0
    return data[:at] + data[at + 2 :]


def replaced(data, pattern, new, rng):
    found = list(re.finditer(pattern, data))
    if not found:
        return data
    start, end = rng.choice(found).span()
    return data[:start] + new + data[end:]


def change_number(data, rng):
    return replaced(data, NUMBER, rng.choice(NUMBERS.split()).encode(), rng)


def change_unit(data, rng):
    return replaced(data, rb'(?<=[0-9]) [A-Za-z/ ^2]+(?=")', b" " + rng.choice(UNITS.split("|")).encode(), rng)


def misspell(data, rng):
    word = rng.choice(WORD.findall(data) or [b"x"])
    i = rng.randrange(len(word))
    wrong = rng.choice([word[:i] + word[i + 1 :], word[: i + 1] + word[i:], word.upper(), word[:i] + b"x" + word[i + 1 :]])
    return replaced(data, rb"\b%s\b" % re.escape(word), wrong, rng)


def swap_words(data, rng):
    words = WORD.findall(data) or [b"x"]
    return replaced(data, rb"\b%s\b" % re.escape(rng.choice(words)), rng.choice(words), rng)


def insert_text(data, rng):
    i = rng.randrange(len(data))
    return data[:i] + rng.choice(TEXTS.split("|")).encode() + data[i:]


def nest(data, rng):
    depth = rng.choice([2, 10, 100, 3000])
    opening, closing = rng.choice([(b"[", b"]"), (b"{a=", b"}"), (b"[", b"")])
    return replaced(data, NUMBER, opening * depth + b"1" + closing * depth, rng)


def long_value(data, rng):
    return replaced(
        data, rng.choice([NUMBER, WORD]), rng.choice([b"9", b"a", b"a.", b"m ", b'"']) * rng.choice([100, 5000]), rng
    )


def windows(data, rng):
    return b"\xef\xbb\xbf" + data.replace(b"\n", b"\r\n")


MUTATIONS = [
    *(flip_byte, delete_span, repeat_span, truncate, delete_line, repeat_line, swap_lines, insert_line, uncomment),
    *(change_number, change_number, change_unit, change_unit, misspell, swap_words, insert_text, nest, long_value, windows),
]


def mutated(sources, rng):
    data = rng.choice(sources)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 6])):
        data = rng.choice(MUTATIONS)(data, rng) or b" "
    return data


def numbers(value):
    """Every number in a design."""
    if dataclasses.is_dataclass(value):
        value = [getattr(value, field.name) for field in dataclasses.fields(value)]
    if isinstance(value, (tuple, list)):
        for part in value:
            yield from numbers(part)
    elif isinstance(value, (int, float)):
        yield value


def check(path, data):
    path.write_bytes(data)
    begin = time.perf_counter()
    try:
        design = load_design(path)
    except InputError as error:
        assert str(error).startswith(f"{path.parent}")
        assert re.match(r"[^:]+:\d+:\d+: ", str(error)), str(error)
        assert set(str(error)).isdisjoint("\0\r\x1b\u202e\u2028")
        design = None
    assert time.perf_counter() - begin < SLOWEST
    if design is not None:
        assert isinstance(design, Design)
        assert all(map(math.isfinite, numbers(design)))
        assert parse_design(design.source, folder=path.parent) == design
    return design is not None


@pytest.mark.parametrize("count", [2_000, pytest.param(100_000, marks=pytest.mark.long)])
def test_a_damaged_design_file_loads_or_is_refused_with_its_place(tmp_path, count):
    sources = [*(design_path(name).read_bytes() for name in shipped_designs()), starting_file().encode()]
    (tmp_path / "wheel.csv").write_text("angle,radius\n0,0.025\n2,0.026\n4,0.025\n")
    loaded = 0
    for i in range(count):
        data = mutated(sources, random.Random(SEED + i))
        try:
            loaded += check(tmp_path / "design.toml", data)
        except Exception as error:
            raise AssertionError(f"file {i} (seed {SEED + i}): {type(error).__name__}: {error}") from error
    # Both outcomes must have been tried: comments and equal values leave some files sound.
    assert 0.05 * count < loaded < 0.95 * count
