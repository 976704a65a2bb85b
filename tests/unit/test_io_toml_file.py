"""Reading TOML: text that is none, and where keys and values stand."""

import os

import pytest

from spheredrive.errors import InputError
from spheredrive.io.files import write_whole
from spheredrive.io.toml_file import parse_toml, read_toml

TEXT = '''top = 1
"quoted.key" = 'a # b'
dotted.inner."deep one" = [1, [2, 3], { x = "}", y = [4] }]

[wheels.omni]   # comment with ] and "
radius = "25 mm"
long = """a
[not.a.table]
b"""
list = [
    1, # one ]
    "two, 2",
]
when = 1979-05-27 07:32:00
[[placement]]
elevation = -1
[[placement]]
elevation = -2
sub.x = 1
[placement.table]
y = 2
[ "spaced out" . 'b' ]
\tz = true
'''


@pytest.mark.parametrize(
    ("path", "of", "place", "marked"),
    [
        (("top",), "key", (1, 1), "top"),
        (("top",), "value", (1, 7), "1"),
        (("quoted.key",), "key", (2, 1), '"quoted.key"'),
        (("quoted.key",), "value", (2, 16), "'a # b'"),
        (("dotted",), "key", (3, 1), "dotted"),
        (("dotted", "inner", "deep one"), "key", (3, 14), '"deep one"'),
        (("dotted", "inner", "deep one", 1, 1), "value", (3, 35), "3"),
        (("dotted", "inner", "deep one", 2, "x"), "key", (3, 41), "x"),
        (("dotted", "inner", "deep one", 2, "x"), "value", (3, 45), '"}"'),
        (("dotted", "inner", "deep one", 2, "y", 0), "value", (3, 55), "4"),
        (("wheels",), "key", (5, 2), "wheels"),
        (("wheels", "omni"), "key", (5, 9), "omni"),
        (("wheels", "omni"), "value", (5, 1), "[wheels.omni]"),
        (("wheels", "omni", "radius"), "value", (6, 10), '"25 mm"'),
        (("wheels", "omni", "long"), "value", (7, 8), '"""a'),
        (("wheels", "omni", "list", 1), "value", (12, 5), '"two, 2"'),
        (("wheels", "omni", "when"), "value", (14, 8), "1979-05-27 07:32:00"),
        (("placement",), "value", (15, 1), "[[placement]]"),
        (("placement", 0, "elevation"), "value", (16, 13), "-1"),
        (("placement", 1), "value", (17, 1), "[[placement]]"),
        (("placement", 1, "elevation"), "value", (18, 13), "-2"),
        (("placement", 1, "sub", "x"), "value", (19, 9), "1"),
        (("placement", 1, "table", "y"), "value", (21, 5), "2"),
        (("spaced out", "b", "z"), "key", (23, 2), "z"),
        (("wheels", "omni", "absent"), "key", (5, 1), "[wheels.omni]"),
        (("nothing", "at", "all"), "value", (1, 1), "t"),
    ],
)
def test_locate_every_form_of_toml_is_found(path, of, place, marked):
    found = parse_toml(TEXT, "some.toml").locate(path, of)
    assert (found.line, found.column) == place
    assert found.text[found.column - 1 : found.column - 1 + found.length] == marked


def test_locate_counts_characters_not_bytes():
    found = parse_toml('"ключ" = "ö"\nx = ["é", 5]\n', "f").locate(("x", 1))
    assert (found.line, found.column) == (2, 11)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("a = 1\na = 2\n", "2:1", "given twice"),
        ("[t]\n[u]\n[t]\n", "3:1", "given twice"),
        ("x = { a = 1, a = 2 }\n", "1:", "given twice"),
        ("radius = 25 mm\n", "1:13", "in quotes"),
        ("radius = mm\n", "1:10", "in quotes"),
        ("radius = 25,4\n", "1:12", "not a decimal point"),
        ("a = 1\nradius 25\n", "2:8", "followed by ="),
        ("a = [1, 2\n\n", "1:10", "closed by ]"),
        ('a = "x\nb = 1\n', "1:7", "closing quote"),
        ("[a\nb = 1\n", "1:3", "closed by ]"),
        ("= 5\n", "1:1", "neither a key"),
        ("a = 1\n" + "b = " + "[" * 5000 + "\n", "2:5004", "nested too deeply"),
        ("a = 1\nb = " + "1" * 5000 + "\n", "2:5", "too many digits"),
        ("\n" + "a." * 100_000 + "b = 1\n", "2:1", "parts at most"),
        ("a = 1\nb = '\0'\n", "2:6", "NUL"),
    ],
)
def test_parse_toml_what_is_no_toml_is_refused_with_its_place(text, place, words):
    with pytest.raises(InputError) as refusal:
        parse_toml(text, "some.toml")
    assert str(refusal.value).startswith(f"some.toml:{place}")
    assert words in str(refusal.value)


def test_parse_toml_a_terminal_is_not_sent_control_characters():
    with pytest.raises(InputError) as refusal:
        parse_toml("a = \x1b[31m\n", "f")
    assert "\x1b" not in str(refusal.value)


def test_read_toml_mark_and_line_ends_of_windows_are_taken_off(tmp_path):
    path = tmp_path / "w.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\r\nb = '''x\r\ny'''\r\n")
    document = read_toml(path)
    assert document.data == {"a": 1, "b": "x\ny"}
    assert document.locate(("b",), "key").line == 2


@pytest.mark.parametrize(
    ("content", "words"),
    [(b"a = '\xff'\n", ":1:6: is not UTF-8"), (b"a = 1\n" * 300_000, "larger than 1 MiB"), (b"a\0", ":1:2: has a NUL")],
)
def test_read_toml_what_is_no_text_is_refused(tmp_path, content, words):
    path = tmp_path / "bad.toml"
    path.write_bytes(content)
    with pytest.raises(InputError) as refusal:
        read_toml(path)
    assert str(refusal.value).startswith(str(path))
    assert words in str(refusal.value)


def test_read_toml_no_file_is_a_sentence(tmp_path):
    for path, words in [(tmp_path / "no.toml", "no such file"), (tmp_path, "is a folder"), (os.devnull, "is not a file")]:
        with pytest.raises(InputError, match=words):
            read_toml(path)
    with pytest.raises(InputError, match="name"):
        read_toml("a\0b")


def test_write_whole_replaces_and_leaves_nothing_else(tmp_path):
    path = tmp_path / "out.txt"
    write_whole(path, "one")
    write_whole(path, b"two")
    assert path.read_text() == "two"
    assert list(tmp_path.iterdir()) == [path]


def test_write_whole_failures_are_sentences(tmp_path):
    path = tmp_path / "out.txt"
    path.write_text("kept")
    with pytest.raises(InputError, match="not overwritten"):
        write_whole(path, "new", replace=False)
    assert path.read_text() == "kept"
    with pytest.raises(InputError, match="is a folder"):
        write_whole(tmp_path, "new")
    with pytest.raises(InputError, match="no such folder"):
        write_whole(tmp_path / "absent" / "out.txt", "new")
    assert list(tmp_path.iterdir()) == [path]


def test_write_whole_a_link_is_followed_and_stays(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("old")
    link.symlink_to(target)
    write_whole(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_write_whole_a_device_is_written_not_replaced():
    write_whole(os.devnull, "nothing")
    assert not os.path.isfile(os.devnull)
