"""Linear vibration, model.md section 5b: what a user calls, gathered from the files beside this one."""

from spheredrive.vibration.assessment import Assessment, assess
from spheredrive.vibration.batch import SteadyStatistics, steady_statistics
from spheredrive.vibration.campbell import Crossing, SpeedBand, critical_speeds, passing_lines, speeds_to_avoid
from spheredrive.vibration.comfort import Comfort, comfort_of_lines, comfort_words, weighting
from spheredrive.vibration.comfort_history import ComfortHistory, comfort_of_history
from spheredrive.vibration.equations import Isolator
from spheredrive.vibration.isolation import isolator_for
from spheredrive.vibration.modes import Modes, frequency_response, modes, transmissibility
from spheredrive.vibration.payload import isolator_for_design, isolator_of_frequency, without_payload
from spheredrive.vibration.pressing import PressingForce, pressing_force
from spheredrive.vibration.response import Impulse, Instant, LostContact, Response, Sizes, response
from spheredrive.vibration.spectrum import OrderSpectrum, order_spectrum, shape_harmonics
from spheredrive.vibration.system import LinearSystem, linear_system
from spheredrive.vibration.transient import (
    Transient,
    TransientStatistics,
    transient,
    transient_blocks,
    transient_statistics,
)

__all__ = [
    "Assessment",
    "Comfort",
    "ComfortHistory",
    "Crossing",
    "Impulse",
    "Instant",
    "Isolator",
    "LinearSystem",
    "LostContact",
    "Modes",
    "OrderSpectrum",
    "PressingForce",
    "Response",
    "Sizes",
    "SpeedBand",
    "SteadyStatistics",
    "Transient",
    "TransientStatistics",
    "assess",
    "comfort_of_history",
    "comfort_of_lines",
    "comfort_words",
    "critical_speeds",
    "frequency_response",
    "isolator_for",
    "isolator_for_design",
    "isolator_of_frequency",
    "linear_system",
    "modes",
    "order_spectrum",
    "passing_lines",
    "pressing_force",
    "response",
    "shape_harmonics",
    "speeds_to_avoid",
    "steady_statistics",
    "transient",
    "transient_blocks",
    "transient_statistics",
    "transmissibility",
    "weighting",
    "without_payload",
]
