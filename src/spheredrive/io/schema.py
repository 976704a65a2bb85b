"""The shape of design and motion files: pydantic models made from the fields of the value classes.

A key's unit, range, choices, default and words are declared once, at the field (``values.quantity`` and its siblings).
Here every such field becomes a validator and a piece of JSON Schema; no key of a value class is listed.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal, Union, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    create_model,
)

from spheredrive import design
from spheredrive.errors import DesignError
from spheredrive.io import sections
from spheredrive.io.quantity import NUMBER
from spheredrive.io.readers import (
    SCHEMA_VERSION,
    read_flag,
    read_inertia,
    read_quantity,
    read_rows,
    read_version,
    read_whole,
    read_word,
)
from spheredrive.wheels import TYPES

_NUMBER = NUMBER.replace("[+-]", "[+\N{MINUS SIGN}-]", 1)
_ROWS = {"type": "array", "items": {"type": "array", "items": {"type": ["number", "string"]}}}


def model_of(cls: type, name: str = "", skip: tuple[str, ...] = (), extra: dict[str, Any] | None = None) -> type[BaseModel]:
    """The pydantic model of a dataclass's declared fields: unknown keys are refused, quantities come out in SI."""
    fields: dict[str, Any] = dict(extra or {})
    for field in dataclasses.fields(cls):
        if field.metadata and field.name not in skip:
            key = field.metadata.get("key", field.name)
            fields[key] = (_annotation(field, key), _field_info(field))
    doc = (cls.__doc__ or "").split("\n\n")[0].replace("\n", " ").replace("``", "")
    return _model(name or cls.__name__, name or cls.__name__, fields, doc)


def _model(name: str, title: str, fields: Any, doc: str | None = None) -> type[BaseModel]:
    return create_model(name, __config__=ConfigDict(extra="forbid", frozen=True, title=title), __doc__=doc, **fields)


def _field_info(field: dataclasses.Field) -> Any:
    meta = field.metadata
    unit = f"; {meta['unit']} where a number is bare" if meta.get("unit") else ""
    required = field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    default = ... if required else (field.default if field.default is not dataclasses.MISSING else None)
    return Field(default, description=f"{meta['doc']}{unit}")


def _annotation(field: dataclasses.Field, key: str) -> Any:
    meta = field.metadata
    if "unit" in meta:
        read = functools.partial(read_quantity, meta=meta, shape=meta["shape"], name=key)
        return _value(read, _quantity_schema(meta, meta["shape"]))
    if "least" in meta:
        schema = {"type": "integer", "minimum": meta["least"], "maximum": meta["most"]}
        return _value(functools.partial(read_whole, meta=meta), schema)
    if "flag" in meta:
        return _value(read_flag, {"type": "boolean"})
    if "inertia" in meta:
        return _value(read_inertia, _inertia_schema())
    if "items" in meta:
        return list[model_of(meta["items"])]
    if "numbers" in meta:
        return _value(functools.partial(read_rows, name=key), _ROWS)
    choices = meta.get("choices", ())
    schema = {"type": "string", **({"enum": list(choices)} if choices else {})}
    return _value(functools.partial(read_word, choices=choices), schema)


def _value(read: Callable, schema: dict[str, Any]) -> Any:
    return Annotated[Any, PlainValidator(read), WithJsonSchema(schema)]


def _quantity_schema(meta: Any, shape: tuple) -> dict[str, Any]:
    if shape:
        size = {"minItems": shape[0], "maxItems": shape[0]} if shape[0] else {}
        return {"type": "array", "items": _quantity_schema(meta, shape[1:]), **size}
    bound = {"positive": {"exclusiveMinimum": 0}, "non-negative": {"minimum": 0}}.get(meta["sign"], {})
    unit = meta["unit"]
    rest = r"[^\s0-9.].*" if unit else "(percent|%)?"
    text: dict[str, Any] = {"type": "string", "pattern": rf"^\s*{_NUMBER}\s*{rest}$"}
    if unit:
        text["examples"] = [f"1 {unit}"]
    return {"anyOf": [{"type": "number", **bound}, text]}


def _inertia_schema() -> dict[str, Any]:
    meta = {"unit": "kg m^2", "sign": "any"}
    return {
        "anyOf": [{"type": "string", "enum": ["hollow", "solid"]}, _quantity_schema(meta, (3,)), _quantity_schema(meta, (3, 3))]
    }


_VERSION = (_value(read_version, {"const": SCHEMA_VERSION}), Field(..., description="version of this file format"))
_CATALOGUE = (
    _value(functools.partial(read_word, choices=()), {"type": "string"}),
    Field(None, description="a part of the catalogue of real wheels, maker/part, whose keys are taken first"),
)


@functools.lru_cache(maxsize=1)
def wheel_models() -> dict[str, type[BaseModel]]:
    """The model of each wheel type."""
    return {
        name: model_of(
            wheel,
            wheel.__name__,
            ("name",),
            {"type": (Literal[name], Field(..., description="wheel type")), "catalogue": _CATALOGUE},
        )
        for name, wheel in TYPES.items()
    }


def _placement_kind(entry: Any) -> str:
    given = entry if isinstance(entry, dict) else {}
    return "vectors" if "contact" in given or "drive" in given else "ring"


@functools.lru_cache(maxsize=1)
def design_model() -> type[BaseModel]:
    """The model of a design file."""
    wheel = Annotated[Union[tuple(wheel_models().values())], Field(discriminator="type")]  # noqa: UP007
    ring, vectors = model_of(sections.Ring), model_of(sections.Vectors)
    placement = Annotated[Annotated[ring, Tag("ring")] | Annotated[vectors, Tag("vectors")], Discriminator(_placement_kind)]
    fields = {field.name: field for field in dataclasses.fields(design.Design)}
    parts = {name: field.default_factory for name, field in fields.items() if field.default_factory is not dataclasses.MISSING}
    return _model(
        "DesignFile",
        "spheredrive design file",
        {
            "schema_version": _VERSION,
            "name": (_annotation(fields["name"], "name"), _field_info(fields["name"])),
            "sphere": (model_of(design.Sphere), Field(..., description="the driven sphere")),
            "wheels": (dict[str, wheel], Field(..., min_length=1, description="wheel models by name")),
            "placement": (
                Annotated[list[placement], BeforeValidator(_placements)],
                Field(..., description="where wheels stand: rings or single wheels"),
            ),
            **{name: (model_of(part), Field(None, description=part.__doc__)) for name, part in parts.items()},  # type: ignore
        },
    )


def _placements(value: Any) -> Any:
    if isinstance(value, list) and not value:
        raise DesignError("a design needs at least one wheel")
    return value


@functools.lru_cache(maxsize=1)
def motion_model() -> type[BaseModel]:
    """The model of a motion file."""
    return _model(
        "MotionFile",
        "spheredrive motion file",
        {
            "schema_version": _VERSION,
            "motion": (model_of(sections.Motion), Field(..., description="what is asked of the machine")),
            "initial": (model_of(sections.Initial), Field(None, description="how it starts")),
            "stage": (model_of(sections.Stage, "StageMotion"), Field(None, description="what moves the stage; held if absent")),
            "output": (model_of(sections.Output), Field(None, description="what the results hold")),
        },
    )


def keys_at(model: type[BaseModel], loc: Sequence[str | int]) -> tuple[list[str], list[str]]:
    """The keys of the table at pydantic's path ``loc``, and those of the other kind of table that may stand there."""
    if len(loc) > 2 and loc[0] == "wheels":
        return list(wheel_models()[str(loc[2])].model_fields), []
    if len(loc) > 2 and loc[0] == "placement":
        ring, vectors = ([field.name for field in dataclasses.fields(kind)] for kind in (sections.Ring, sections.Vectors))
        return (vectors, ring) if loc[2] == "vectors" else (ring, vectors)
    for part in loc:
        if isinstance(part, str):
            annotation: Any = model.model_fields[part].annotation
            model = next((a for a in get_args(annotation) if isinstance(a, type)), annotation)
    return list(model.model_fields), []


def design_schema() -> dict[str, Any]:
    """The JSON Schema of design files (draft 2020-12)."""
    schema = design_model().model_json_schema()
    by_type = schema["properties"]["wheels"]["additionalProperties"]
    schema["$defs"]["CatalogueWheel"] = _catalogue_wheel_schema(schema["$defs"])
    schema["properties"]["wheels"]["additionalProperties"] = {"anyOf": [by_type, {"$ref": "#/$defs/CatalogueWheel"}]}
    return _finished(schema)


def _catalogue_wheel_schema(definitions: dict[str, Any]) -> dict[str, Any]:
    """A wheel that takes its type from the catalogue may leave out every key but that."""
    properties: dict[str, Any] = {}
    for model in wheel_models().values():
        properties = {**definitions[model.__name__]["properties"], **properties}
    return {
        "title": "CatalogueWheel",
        "type": "object",
        "description": "a wheel of the catalogue; keys given here override",
        "properties": {**properties, "type": {"enum": list(TYPES)}, "catalogue": {"type": "string"}},
        "required": ["catalogue"],
        "additionalProperties": False,
    }


def motion_schema() -> dict[str, Any]:
    """The JSON Schema of motion files (draft 2020-12)."""
    return _finished(motion_model().model_json_schema())


def _finished(schema: dict[str, Any]) -> dict[str, Any]:
    """Without the nulls that stand for absent keys: TOML has none."""
    for part in [schema, *schema.get("$defs", {}).values()]:
        for entry in part.get("properties", {}).values():
            if entry.get("default", ...) is None:
                del entry["default"]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
