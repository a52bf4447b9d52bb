"""One clean flight for all tests that only look."""

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
import pytest

from .hidden_bags import hidden_bags as hidden_bags
from .hidden_flight import flown, nominal, prepared

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.fixture(scope='session')
def gtmab() -> Known:
    """The GT-MAB as its file has it, and its knobs."""
    return nominal()


@pytest.fixture(scope='session')
def clean(gtmab: Known) -> FlightLinearizer:
    """Half a minute in which nothing is hidden."""
    return prepared(flown({}, 1, 32.0), gtmab[1])
