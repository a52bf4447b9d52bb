"""The numbers of a flight of a batch: what stays the same during it, and what it comes to."""

from typing import NamedTuple

from lta_control.mission import MissionSettings
from lta_control.onboard import DroneConstants
from lta_control.per_rotor import PerRotor
from lta_control.reserve import ReserveRule
from lta_model.electrical.loads import LoadModel
from lta_model.light.panel_light import PanelPlane
from lta_sim.compiled_sensors import SensorDatasheets
from lta_sim.environment import SteadyWind
from lta_sim.light_link import LightLink
from lta_sim.supply_step import SupplyParts
from lta_sim.termination import FlightGoal, GoalProgress
from lta_vlc.reading_model import DirectionPrior, FitArray

Vector = tuple[float, float, float]


class BatchPower(NamedTuple):
    """The electricity: what feeds the vehicle, its loads, and its panel."""

    parts: SupplyParts
    loads: LoadModel
    looking: float  # W, what lamps are found with
    panel: PanelPlane
    lamp_share: float  # W/m2 a lux of the lamp while it is on
    ambient: float  # W/m2
    day_share: float  # W/m2 a lux of daylight
    reserve: float
    charge: float


class FlightConstants(NamedTuple):
    """
    Everything that decides a flight but its seed and the kernel's own numbers.

    Attributes
    ----------
    drone : Drone
        What the drone knows.
    mission : MissionSettings
        Altitudes and speeds.
    sensors, listening, goal, power : SensorDatasheets, LightLink, FlightGoal, BatchPower
        The world.
    array, expected : Array, Expected
        What the drone believes of its diodes and of the lamp.
    place : tuple of float
        Of the hull centre at the start. [m, map]
    heading, spread : float
        Middle and half width of the headings at the start. [rad]
    wind : SteadyWind
        Of the scene.
    held : float
        Time for which a hand holds the drone. [s]
    lowest : PerRotor
        Least duty of each rotor.
    mass_place : tuple of float
        Of the moving mass. [m, body]
    duties : PerRotor
        In an open loop.
    reserve : ReserveRule
        Action at the energy reserve.
    diode_scale : float
        Gain of the selected resistor relative to the largest one.

    """

    drone: DroneConstants
    mission: MissionSettings
    sensors: SensorDatasheets
    listening: LightLink
    array: FitArray
    expected: DirectionPrior
    goal: FlightGoal
    power: BatchPower
    place: Vector
    heading: float
    spread: float
    wind: SteadyWind
    held: float
    lowest: PerRotor
    mass_place: Vector
    duties: PerRotor
    reserve: ReserveRule
    diode_scale: float


class FlightTally(NamedTuple):
    """What a flight has come to; NaN is what has not happened. SI."""

    outcome: int
    progress: GoalProgress
    lift_off: float
    search_start: float
    path_length: float
    closest: float
    energy: float
    blocks: float  # since the search began
    bearings: float  # of these, with a bearing
    squares: float  # of their errors, summed [rad2]
