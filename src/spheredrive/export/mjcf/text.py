"""The model as the text of an MJCF file, with what a reader has to know at its head."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spheredrive.export.mjcf.model import contact_law, linear_contact, mjcf_spec
from spheredrive.wheels.base import RollerWheel

if TYPE_CHECKING:
    from spheredrive.design import Design

SHAPES = {
    "sphere": "spheres, exact",
    "capsule": "capsules, exact",
    "cylinder": "cylinders, exact",
    "barrel": "barrels, as convex meshes within a few micrometres of the exact outline",
}


def mjcf_text(design: Design, **options) -> str:
    """The MJCF file of ``design``; ``options`` and errors as ``mjcf_spec``.

    Numbers are written with six digits, as MuJoCo does.
    """
    spec = mjcf_spec(design, **options)
    spec.comment = _head(design)
    spec.compile()
    return spec.to_xml()


def _head(design: Design) -> str:
    kinds = sorted({wheel.roller_shape for wheel in design.wheels if isinstance(wheel, RollerWheel)})
    contact, law = linear_contact(design), contact_law(design)
    lines = [
        f"{design.name}: made by spheredrive. SI units; origin at the sphere's nominal centre, z up.",
        f"Rollers are {'; '.join(SHAPES[kind] for kind in kinds)}. Each turns on a hinge of its own.",
    ]
    if contact.stiffness:
        lines.append(
            f"Contacts have stiffness {contact.stiffness:g} N/m and damping {contact.damping:g} N s/m each; the numbers in "
            "solref hold for the masses in this file."
        )
        lines.append(f"Friction {law.friction:g} grows with the slip at {law.friction_slope:.4g} N s/m up to its limit.")
    else:
        lines.append("The design gives no contact stiffness: contacts are MuJoCo's own stiff ones.")
    if contact != design.contact:
        lines.append(
            "The design's contact law is not straight: these are its slopes under the sphere's weight and closure force."
        )
    if contact.rolling_arm or contact.spin_arm:
        lines.append("Rolling and spin resistance are not in this model.")
    gains = design.motor.proportional_gain or design.motor.integral_gain
    lines.append(f"Controls motor_1, motor_2, ... are {'speeds in rad/s' if gains else 'torques in N m'}.")
    # Two hyphens end a comment of XML.
    return "\n".join(f"  {line}" for line in ["", *lines, ""]).replace("--", "- -")
