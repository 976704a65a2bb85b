"""Kinematics of a sphere on wheels, model.md section 2: what a user calls, gathered from the files beside this one."""

from spheredrive.kinematics.contacts import (
    Contacts,
    Races,
    constraint,
    constraint_row,
    contacts,
    equivalent_contact,
)
from spheredrive.kinematics.instant import instantaneous_constraint, instantaneous_jacobian
from spheredrive.kinematics.maps import (
    MasterSlave,
    Slip,
    Transmission,
    forward,
    inverse,
    inverse_jacobian,
    jacobian,
    master_slave,
    slip,
    sphere_acceleration,
    transmission,
    wheel_acceleration,
)
from spheredrive.kinematics.motion import KinematicRun, along
from spheredrive.kinematics.orientation import integrate_orientation
from spheredrive.kinematics.quality import (
    Singularity,
    condition_number,
    determinant,
    effectiveness,
    effectiveness_about,
    isotropy,
    nearest_singularity,
    singular_values,
    singularity_measure,
    worst_directions,
)
from spheredrive.kinematics.races import active_races, race_error, state_index
from spheredrive.kinematics.states import (
    ContactState,
    SlipFree,
    contact_states,
    count_contact_states,
    slip_free,
    worst_contact_state,
)

__all__ = [
    "ContactState", "Contacts", "KinematicRun", "MasterSlave", "Races", "Singularity", "Slip", "SlipFree",
    "Transmission", "active_races", "along", "condition_number", "constraint", "constraint_row", "contact_states",
    "contacts", "count_contact_states", "determinant", "effectiveness", "effectiveness_about", "equivalent_contact",
    "forward", "instantaneous_constraint", "instantaneous_jacobian", "integrate_orientation", "inverse",
    "inverse_jacobian", "isotropy", "jacobian", "master_slave", "nearest_singularity", "race_error",
    "singular_values", "singularity_measure", "slip", "slip_free", "sphere_acceleration", "state_index",
    "transmission", "wheel_acceleration", "worst_contact_state", "worst_directions",
]  # fmt: skip
