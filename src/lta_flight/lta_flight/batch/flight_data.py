"""Data of a batch flight: its constants, and the tally of its results."""

from typing import NamedTuple

from lta_control.mission import MissionSettings
from lta_control.onboard import DroneConstants
from lta_control.per_rotor import PerRotor
from lta_model.electrical.loads import LoadModel
from lta_model.light.panel_light import PanelPlane
from lta_sim.compiled_sensors import SensorDatasheets
from lta_sim.light_link import LightLink
from lta_sim.supply_step import SupplyParts
from lta_vlc.reading_model import DirectionPrior, FitArray

Vector = tuple[float, float, float]


class BatchGoal(NamedTuple):
    """The goal and the bounds of a flight, as in `lta_sim.termination`."""

    x: float
    y: float
    radius: float
    limit: float
    half_length: float
    half_width: float
    height: float


class BatchPower(NamedTuple):
    """The electrical system: supply, loads and panel."""

    parts: SupplyParts
    loads: LoadModel
    looking: float  # W, power of light sensing and navigation
    panel: PanelPlane
    lamp_share: float  # W/m2 per lux of the lamp's on phase
    ambient: float  # W/m2
    day_share: float  # W/m2 per lux of daylight
    reserve: float
    charge: float


class FlightConstants(NamedTuple):
    """
    Everything that determines a flight except its seed and the model's own numbers.

    Attributes
    ----------
    drone : DroneConstants
        The drone's knowledge of itself.
    mission : MissionSettings
        Altitudes and speeds.
    sensors, listening, goal, power : SensorDatasheets, LightLink, BatchGoal, BatchPower
        The world.
    array, expected : FitArray, DirectionPrior
        The drone's model of its diodes, and its prior on the lamp.
    place : tuple of float
        Hull centre at the start. [m, map]
    heading, spread : float
        Centre and half width of the initial headings. [rad]
    wind : tuple of float
        [m/s, map]
    lowest : PerRotor
        Minimum duty of each rotor.
    mass_place : tuple of float
        Position of the moving mass. [m, body]
    duties : PerRotor
        Duties in an open loop.

    """

    drone: DroneConstants
    mission: MissionSettings
    sensors: SensorDatasheets
    listening: LightLink
    array: FitArray
    expected: DirectionPrior
    goal: BatchGoal
    power: BatchPower
    place: Vector
    heading: float
    spread: float
    wind: Vector
    lowest: PerRotor
    mass_place: Vector
    duties: PerRotor


class FlightTally(NamedTuple):
    """Running results of a flight in SI units; NaN for events that have not happened."""

    outcome: int
    lift_off: float
    search_start: float
    path_length: float
    closest: float
    energy: float
    blocks: float  # light blocks since the search began
    bearings: float  # number of them with a bearing
    squares: float  # sum of squared bearing errors [rad2]
