"""The JSON Schema takes what the reader takes, and knows every key."""

import tomllib
from pathlib import Path

import pytest

from spheredrive.designs import design_path, motion_path, shipped_designs, shipped_motions
from spheredrive.io.schema import design_schema, motion_schema
from spheredrive.io.template import starting_file
from spheredrive.wheels import TYPES

jsonschema = pytest.importorskip("jsonschema")
DATA = Path(__file__).parents[1] / "data"


def faults(schema, text):
    validator = jsonschema.Draft202012Validator(schema)
    return [error.message for error in validator.iter_errors(tomllib.loads(text))]


def test_design_schema_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(design_schema())
    jsonschema.Draft202012Validator.check_schema(motion_schema())


def test_design_schema_accepts_what_loads():
    texts = [design_path(name).read_text() for name in shipped_designs()]
    for text in [*texts, starting_file(), (DATA / "interface-example.toml").read_text()]:
        assert faults(design_schema(), text) == []


def test_motion_schema_accepts_what_loads():
    for text in [*(motion_path(name).read_text() for name in shipped_motions()), (DATA / "interface-motion.toml").read_text()]:
        assert faults(motion_schema(), text) == []


def test_design_schema_accepts_a_wheel_of_the_catalogue():
    text = (DATA / "interface-example.toml").read_text()
    start, end = text.index("[wheels.omni]"), text.index("[[placement]]")
    text = f'{text[:start]}[wheels.omni]\ncatalogue = "a/b"\n{text[end:]}'
    assert faults(design_schema(), text) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('radius = "15 cm"', 'raduis = "15 cm"'),
        ('radius = "15 cm"', 'radius = "15"'),
        ('radius = "15 cm"', "radius = -1"),
        ("count = 3", "count = 0"),
        ('type = "dual-race"', 'type = "dual"'),
        ("gravity = true", "gravity = 1"),
        ("schema_version = 1", "schema_version = 2"),
    ],
)
def test_design_schema_refuses_what_does_not_load(old, new):
    text = (DATA / "interface-example.toml").read_text()
    assert old in text
    assert faults(design_schema(), text.replace(old, new, 1))


def test_design_schema_describes_every_key_of_every_type():
    definitions = design_schema()["$defs"]
    for wheel in TYPES.values():
        for key, entry in definitions[wheel.__name__]["properties"].items():
            assert entry.get("description"), (wheel.__name__, key)
