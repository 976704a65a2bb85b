"""The catalogue of real wheels: published figures by maker and part."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True)
class CatalogueEntry:
    """One part: ``keys`` are those of a wheel model in a design file, ``sources`` say where the figures were read."""

    name: str
    maker: str
    part: str
    keys: MappingProxyType[str, Any]
    sources: tuple[str, ...]


@lru_cache(maxsize=1)
def catalogue() -> MappingProxyType[str, CatalogueEntry]:
    """Every part by its name, ``maker/part``."""
    text = resources.files("spheredrive.wheels").joinpath("catalogue.toml").read_text("utf-8")
    entries = {}
    for name, table in tomllib.loads(text).items():
        about = {key: table.pop(key) for key in ("maker", "part", "sources")}
        sources = tuple(about["sources"])
        entries[name] = CatalogueEntry(name, about["maker"], about["part"], MappingProxyType(table), sources)
    return MappingProxyType(entries)
