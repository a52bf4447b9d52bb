"""Data of a batch flight: its constants, and the tally of its results."""

from typing import NamedTuple

from lta_control.allocation import PerRotor
from lta_control.flight_step import DroneConstants
from lta_control.mission import MissionSettings
from lta_control.reserve import ReserveRule
from lta_model.light.readings import PanelPlane
from lta_model.light.view import LightWeights
from lta_sim.compiled_sensors import SensorDatasheets
from lta_sim.environment import SteadyWind
from lta_sim.light_link import LightLink
from lta_sim.supply import SupplyConstants
from lta_sim.termination import EndConditions, GoalProgress
from lta_vlc.reading_model import DiodeFitInputs, DirectionPrior

Vector = tuple[float, float, float]


class BatchPower(NamedTuple):
    """The electrical system: supply, loads and panel."""

    supply: SupplyConstants
    panel: PanelPlane
    lamp_shares: tuple[float, ...]  # W/m2 per lux of each lamp's on phase
    ambient: float  # W/m2
    day_share: float  # W/m2 per lux of daylight
    panel_weights: LightWeights  # what the cells make of these lights
    reserve: float
    charge: float


class FlightConstants(NamedTuple):
    """Everything that determines a flight except its seed and the model's own numbers."""

    drone: DroneConstants  # the drone's knowledge of itself
    mission: MissionSettings  # altitudes and speeds
    # The world: sensors, light link, end conditions and power
    sensors: SensorDatasheets
    listening: LightLink
    array: DiodeFitInputs  # the drone's model of its diodes
    expected: DirectionPrior  # its prior on the lamp
    goal: EndConditions
    power: BatchPower
    place: Vector  # hull centre at the start [m, map]
    heading: float  # middle of the headings at the start [rad]
    spread: float  # their half width [rad]
    wind: SteadyWind
    held: float  # time for which a hand holds the drone [s]
    lowest: PerRotor  # minimum duty of each rotor
    # Index of the lamp of each stop, in order; only the first lamp without a route
    route: tuple[int, ...]
    mass_place: Vector  # position of the moving mass [m, body]
    duties: PerRotor  # in an open loop
    reserve: ReserveRule  # action at the energy reserve
    # Gain of the photodiodes' resistor relative to one of 100 kohm [1]
    diode_scale: float


class FlightTally(NamedTuple):
    """Running results of a flight in SI units; NaN for events that have not happened."""

    outcome: int
    progress: GoalProgress
    lift_off: float
    search_start: float
    path_length: float
    closest: float
    energy: float
    blocks: float  # light blocks since the search began
    bearings: float  # number of them with a bearing
    squares: float  # sum of squared bearing errors [rad2]
