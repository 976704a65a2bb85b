"""The thesis's machines, from the shipped designs, and the changes its figures make to them."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import cast

from spheredrive.design import Design
from spheredrive.designs import design_path, motion_path
from spheredrive.io.design_file import load_design
from spheredrive.io.motion_file import load_motion
from spheredrive.motion import Motion
from spheredrive.wheels.base import Wheel
from spheredrive.wheels.mecanum import MecanumWheel
from spheredrive.wheels.standard import StandardWheel


@lru_cache(maxsize=32)
def shipped(name: str) -> Design:
    """A shipped design."""
    return load_design(design_path(name))


def table_2_1() -> Motion:
    """The wheel speeds of Table 2.1 as shipped."""
    return load_motion(motion_path("atlas-table-2-1"), wheel_count=3)


def with_wheel(design: Design, wheel: Wheel) -> Design:
    """The same layout on other wheels."""
    return replace(design, placements=tuple(replace(p, wheel=wheel) for p in design.placements))


def with_wheel_keys(design: Design, **keys) -> Design:
    """The same layout with some keys of its wheels changed."""
    return with_wheel(design, replace(design.wheels[0], **keys))


def standard_wheel(profile: str = "half-sine", **keys) -> StandardWheel:
    """The demonstrator's standard wheel, with the thesis's outline or the exact one."""
    wheel = cast(StandardWheel, shipped("atlas-demonstrator").wheels[0])
    return replace(wheel, profile=profile, **keys)


def mecanum_wheel(profile: str = "half-sine", **keys) -> MecanumWheel:
    """The Mecanum wheel it is compared with."""
    wheel = cast(MecanumWheel, shipped("atlas-mecanum").wheels[0])
    return replace(wheel, profile=profile, **keys)


def orthogonal(wheel: Wheel | None = None, stiffness: float | None = None, damping: float = 0.0) -> Design:
    """The orthogonal benchmark, on round wheels unless another is given; rigid contacts without ``stiffness``."""
    design = shipped("orthogonal")
    return compliant(design if wheel is None else with_wheel(design, wheel), stiffness, damping)


def atlas(wheel: Wheel, stiffness: float | None = None, damping: float = 0.0) -> Design:
    """The demonstrator on ``wheel``; rigid contacts without ``stiffness``."""
    return compliant(with_wheel(shipped("atlas-demonstrator"), wheel), stiffness, damping)


def compliant(design: Design, stiffness: float | None, damping: float = 0.0) -> Design:
    """Contact stiffness K and damping C; None is rigid."""
    return replace(design, contact=replace(design.contact, stiffness=stiffness, damping=damping))


def mounted(design: Design, stiffness: float | None) -> Design:
    """Mount stiffness k; None is rigid."""
    return replace(design, mount=replace(design.mount, stiffness=stiffness))


def closed(design: Design, stiffness: float) -> Design:
    """Closure stiffness K′ opposite every wheel."""
    return replace(design, closure=replace(design.closure, stiffness=stiffness))


def weightless(design: Design) -> Design:
    """Without gravity, as the thesis writes its equations."""
    return replace(design, stage=replace(design.stage, gravity=False))
