"""Define the result of a calibration as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, final

from lta_discovery.model.nominal import NominalVehicle

WIDE: Final = 1.96  # standard deviations of a 95 % interval


@final
@dataclass(frozen=True, slots=True)
class ForecastScore:
    """RMS errors of forecasts at one horizon, over all pieces of some flights."""

    horizon: float  # [s]
    # Position [m] and attitude [rad] with constant body velocity, with the vehicle file, and with
    # the calibration
    coast: tuple[float, float]
    before: tuple[float, float]
    after: tuple[float, float]
    pieces: int  # number of forecasts


@final
@dataclass(frozen=True, slots=True)
class AxisScore:
    """
    RMS position errors of forecasts at one horizon, by direction.

    Along the nose and sideways, by the heading in which a forecast begins, upwards, and of the
    length of the way along the floor, which a turn of the vehicle hardly changes. [m]
    """

    horizon: float  # [s]
    coast: tuple[float, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]
    pieces: int  # number of forecasts


@final
@dataclass(frozen=True, slots=True)
class CalibratedValue:
    """One calibrated number."""

    # Of the parameter; a mass or inertia is a factor on that of the file, with the unit '1'
    name: str
    unit: str
    flight: str  # the flight that it belongs to; '' for the vehicle
    # In the vehicle file, and calibrated
    before: float
    value: float
    ci95: tuple[float, float]  # 95 % interval
    is_known: bool  # whether the flights narrow it down; otherwise the interval is the assumed one
    # Whether the file is off by more than its tolerance explains, or by so much that a discovery
    # goes on from the calibrated file
    is_far: bool
    inseparable: tuple[str, ...]  # parameters that could be changed instead

    @property
    def deviation(self) -> float:
        """Standard deviation, in the unit of the value."""
        return (self.ci95[1] - self.ci95[0]) / (2.0 * WIDE)


@final
@dataclass(frozen=True, slots=True)
class Calibration:
    """Result of a calibration."""

    vehicle: str  # name or file
    # Of the vehicle file, and calibrated, with the mean net lift of the flights; without drag and
    # added mass if those are left to a discovery
    nominal: NominalVehicle
    calibrated: NominalVehicle
    values: tuple[CalibratedValue, ...]  # of the vehicle, then by flight
    # Of forecasts of the training and of the confirming flights
    scores: Mapping[str, tuple[ForecastScore, ...]]
    # What the values were estimated from (`report.METHODS`)
    method: str
    bags: Mapping[str, tuple[str, ...]]
    warnings: tuple[str, ...] = ()
    # By role, as `scores`; at the last horizon, and further ahead if flights are long enough
    axis_scores: Mapping[str, tuple[AxisScore, ...]] = field(default_factory=dict)

    def find(self, name: str) -> CalibratedValue | None:
        """Return a value of the vehicle by name; None if it was not calibrated."""
        return next((one for one in self.values if one.name == name and not one.flight), None)

    def list_of_flights(self, name: str) -> list[CalibratedValue]:
        """Return the values of a parameter that each flight has of its own."""
        return [one for one in self.values if one.name == name and one.flight]
