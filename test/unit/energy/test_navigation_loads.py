"""What finding a lamp takes beyond hovering, against the paper's figures."""

from lta_config.vehicle_file import load_vehicle_file
from lta_energy import loads
import pytest

ENERGY = load_vehicle_file('gtmab').energy
LOADS = loads.Loads.of(ENERGY)


def test_navigation_takes_what_the_paper_prints_beyond_hovering():
    """1523 to 1544 mW of BAG, DES and DGA, less 1333 mW of hovering."""
    still = (0.0,) * 4
    sensing = loads.demand(LOADS, still, True, True) - loads.demand(LOADS, still, True)
    assert sensing == pytest.approx(0.190)
    beyond = [sensing + loads.computing_of(ENERGY, name) for name in ('bag', 'des', 'dga')]
    assert beyond == pytest.approx([0.190, 0.2005, 0.211])
    assert loads.computing_of(ENERGY, 'nobody') == 0.0
