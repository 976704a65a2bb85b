"""What a wheel's outline does to the distance between its centre and the sphere's, by the wheel's angle."""

from spheredrive.shape.closed_forms import (
    rolling_radius_of_spheres,
    rolling_radius_with_gaps,
    valley_of_spheres,
)
from spheredrive.shape.contact_path import Excitation, Wander, excitation, rolling_radius, wander
from spheredrive.shape.envelope import Envelope, nominal_height
from spheredrive.shape.profile import Profile, exact_envelope, profile, profiles
from spheredrive.shape.roller import Roller, roller, tabulated_generatrix
from spheredrive.wheels.mecanum import touching_circles_depth
from spheredrive.wheels.standard import gap_depth, sphere_gap_angle

__all__ = [
    "Envelope",
    "Excitation",
    "Profile",
    "Roller",
    "Wander",
    "exact_envelope",
    "excitation",
    "gap_depth",
    "nominal_height",
    "profile",
    "profiles",
    "roller",
    "rolling_radius",
    "rolling_radius_of_spheres",
    "rolling_radius_with_gaps",
    "sphere_gap_angle",
    "tabulated_generatrix",
    "touching_circles_depth",
    "valley_of_spheres",
    "wander",
]
