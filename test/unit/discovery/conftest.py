"""One clean flight for all tests that only look."""

from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.replay.linearise import Linearised
import pytest

from .hidden_bags import hidden_bags as hidden_bags
from .hidden_flight import flown, nominal, prepared

Known = tuple[Nominal, list[Knob]]


@pytest.fixture(scope='session')
def gtmab() -> Known:
    """The GT-MAB as its file has it, and its knobs."""
    return nominal()


@pytest.fixture(scope='session')
def clean(gtmab: Known) -> Linearised:
    """Half a minute in which nothing is hidden."""
    return prepared(flown({}, 1, 32.0), gtmab[1])
