# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define the result of a calibration as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
import math
from typing import Final, final, NamedTuple

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.state_filter.forecast_scores import ErrorRatio, HorizonErrors
from lta_discovery.state_filter.noise_model import NoiseModel

WIDE: Final = 1.96  # standard deviations of a 95 % interval


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
        """Return the standard deviation, in the unit of the value."""
        return (self.ci95[1] - self.ci95[0]) / (2.0 * WIDE)


@final
@dataclass(frozen=True, slots=True)
class Correction:
    """One effect of which a calibration changed values clearly."""

    effect: str  # name in the registry, 'vehicle', or 'wrench_coupling'
    values: tuple[CalibratedValue, ...]  # those that are clear
    # The calibrated vehicle with the file's values of the effect, and the others as they are then
    # most probable
    without: NominalVehicle


@final
class JudgedCorrection(NamedTuple):
    """An effect that was calibrated, and what that is worth in forecasts."""

    correction: Correction
    ratio: ErrorRatio  # position error of the calibrated vehicle by that without the correction

    @property
    def is_confirmed(self) -> bool:
        """Whether the forecasts are better with it."""
        return self.ratio.ci95[1] < 1.0


@final
@dataclass(frozen=True, slots=True)
class Calibration:
    """Result of a calibration."""

    vehicle: str  # name or file
    # Of the vehicle file, and calibrated, with the mean net lift of the flights
    nominal: NominalVehicle
    calibrated: NominalVehicle
    # The same with the file's drag and added mass, which a discovery names as effects
    without_flows: NominalVehicle
    values: tuple[CalibratedValue, ...]  # of the vehicle, then by flight
    # Of forecasts of the training and of the confirming flights
    scores: Mapping[str, tuple[HorizonErrors, ...]]
    # What the values were estimated from (`report.METHODS`)
    method: str
    bags: Mapping[str, tuple[str, ...]]
    warnings: tuple[str, ...] = ()
    noise: Mapping[str, NoiseModel] = field(default_factory=dict)  # of the training flights
    corrections: tuple[Correction, ...] = ()
    # By forecasts of the confirming flights, the most useful first; none without such flights
    worth: tuple[JudgedCorrection, ...] = ()
    # Of the logarithms of the rates of the free oscillations in roll and pitch
    pendulum_deviations: tuple[float, float] = (math.inf, math.inf)

    @property
    def judging_scores(self) -> tuple[str, tuple[HorizonErrors, ...]]:
        """Return the role of the flights that judge, confirming ones if any, and scores."""
        role = 'confirm' if self.scores.get('confirm') else 'train'
        return role, self.scores.get(role, ())

    def find(self, name: str) -> CalibratedValue | None:
        """Return a value of the vehicle by name; None if it was not calibrated."""
        return next((one for one in self.values if one.name == name and not one.flight), None)

    def list_of_flights(self, name: str) -> list[CalibratedValue]:
        """Return the values of a parameter that each flight has of its own."""
        return [one for one in self.values if one.name == name and one.flight]
