# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""One clean flight for all tests that only look."""

from lta_discovery.flights.measured_flight import resample_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.linear_flight import FlightSystem
from lta_model.vehicle import load_vehicle
import pytest

from .hidden_bags import hidden_bags as hidden_bags
from .hidden_flight import flown, nominal

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='session')
def gtmab() -> Known:
    """The GT-MAB as its file has it, and its parameters."""
    return nominal()


@pytest.fixture(scope='session')
def clean(gtmab: Known) -> FlightSystem:
    """Half a minute in which nothing is hidden."""
    return FlightSystem(load_vehicle('gtmab'), resample_flight(flown({}, 1, 32.0)), gtmab[1])
