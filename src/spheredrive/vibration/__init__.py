"""Linear vibration, model.md section 5b: what a user calls, gathered from the files beside this one."""

from spheredrive.vibration.aboard.comfort import Comfort, comfort_of_lines, comfort_words, weighting
from spheredrive.vibration.aboard.comfort_history import ComfortHistory, comfort_of_history
from spheredrive.vibration.aboard.isolation import isolator_for
from spheredrive.vibration.aboard.payload import isolator_for_design, isolator_of_frequency, without_payload
from spheredrive.vibration.assessment.assess import Assessment, assess
from spheredrive.vibration.assessment.pressing import PressingForce, pressing_force
from spheredrive.vibration.model.equations import Isolator
from spheredrive.vibration.model.modes import Modes, frequency_response, modes, transmissibility
from spheredrive.vibration.model.system import LinearSystem, linear_system
from spheredrive.vibration.motion.batch import SteadyStatistics, steady_statistics
from spheredrive.vibration.motion.response import Impulse, Instant, LostContact, Response, Sizes, response
from spheredrive.vibration.motion.transient import (
    Transient,
    TransientStatistics,
    transient,
    transient_blocks,
    transient_statistics,
)
from spheredrive.vibration.spectra.campbell import Crossing, SpeedBand, critical_speeds, passing_lines, speeds_to_avoid
from spheredrive.vibration.spectra.spectrum import OrderSpectrum, order_spectrum, shape_harmonics

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
