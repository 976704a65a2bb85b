"""The catalogue of real wheels: every part makes a wheel and says where its figures were read."""

import pytest

from spheredrive.io.catalogue import catalogue
from spheredrive.io.design_file import parse_design

DESIGN = """schema_version = 1
name = "one part"
[sphere]
radius = "1 m"
[wheels.part]
catalogue = "{name}"
[[placement]]
count = 3
elevation = "-40 deg"
"""


@pytest.mark.parametrize("name", catalogue())
def test_catalogue_every_part_makes_a_wheel(name):
    entry = catalogue()[name]
    wheel = parse_design(DESIGN.format(name=name)).wheels[0]
    assert (wheel.type, wheel.rollers) == (entry.keys["type"], entry.keys["rollers"])
    assert entry.maker and entry.part and name.count("/") == 1
    assert entry.sources and all(source.startswith("https://") for source in entry.sources)
