# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta vehicle new` from size, mass and motors."""

import math
from pathlib import Path

from lta_analysis.vehicles import NewVehicleRequest
from lta_config.errors import BadInput
from lta_config.files import load_yaml
from lta_flight.flight_spec import build_loop, load_spec
from lta_model.vehicle import load_vehicle, Vehicle
from lta_vehicle.new_vehicle import write_sized_vehicle
from lta_vehicle.validation import validate_vehicle_file
from lta_vehicle.vehicle_estimate import VehicleSize
from pydantic import ValidationError
import pytest

CIGAR = ('--length', '1.2m', '--diameter', '0.5 m', '--mass', '120g', '--thrust', '0.1N',
         '--arm', '0.2m')  # fmt: skip


def write_vehicle(folder: Path, **size: float) -> Vehicle:
    known = {'diameter': 0.5, 'length': 1.2, 'mass': 0.12, 'motors': 3, 'thrust': 0.1, 'arm': 0.2}
    path = folder / 'mine.yaml'
    write_sized_vehicle('mine', VehicleSize(**(known | size)), path)
    return load_vehicle(str(path))


def test_lift_ballast_and_added_mass_follow_from_the_size(tmp_path: Path) -> None:
    vehicle = write_vehicle(tmp_path)
    volume = 4.0 / 3.0 * math.pi * 0.6 * 0.25**2
    lift = volume * 0.93 * (1.2041 - 0.1664)
    assert vehicle.volume == pytest.approx(volume)
    assert vehicle.gross_lift == pytest.approx(lift)
    assert vehicle.ballast_mass == pytest.approx(lift + 0.002 - 0.12, abs=2e-5)
    # Lamb 1932, section 115: k1, k2 of 0.209, 0.702 at 2.0 and 0.156, 0.763 at 2.51
    along, across = (vehicle.added_mass[axis] / (1.2041 * volume) for axis in (0, 1))
    assert along == pytest.approx(0.209 + (0.156 - 0.209) * 0.4 / 0.51, abs=0.004)
    assert across == pytest.approx(0.702 + (0.763 - 0.702) * 0.4 / 0.51, abs=0.004)


def test_inertia_is_that_of_its_four_masses(tmp_path: Path) -> None:
    # A thin film, a bar of 0.4 m with motors and ballast at the same depth, and the gas, which
    # slips along a hull that turns about its axis of symmetry but for its boundary layer
    vehicle = write_vehicle(tmp_path, envelope=0.07, hang=0.3)
    gas, ballast = vehicle.gas_mass, vehicle.ballast_mass
    below = 0.05 + ballast
    depth = below * 0.3 / vehicle.mass
    film, bar = 0.07 * 2.0 * 0.25**2 / 3.0, 0.05 * (0.4**2 + 0.03**2) / 12.0
    roll = film + bar + (0.07 + gas) * depth**2 + below * (0.3 - depth) ** 2
    assert vehicle.inertia[0, 0] == pytest.approx(roll, rel=1e-3)
    assert -vehicle.cg[2] == pytest.approx(depth, rel=1e-3)
    # A diameter of 0.5 m, in which GT-MAB's share of 0.09 m over the diameter turns along
    turning = vehicle.collect_effects()['gas_rotation']
    assert turning['share'] == pytest.approx(0.18)
    assert turning['roll'] == pytest.approx(gas * 2.0 * 0.25**2 / 5.0)


def test_drag_is_hoerner_s_with_a_plate_for_the_gondola(tmp_path: Path) -> None:
    drag = write_vehicle(tmp_path).file.aero
    friction = 1.328 / math.sqrt(1.0 * 1.2 / 1.5e-5)
    hull = 0.44 / 2.4 + 4.0 * friction * 2.4 + 4.0 * friction / math.sqrt(2.4)
    by_hand = 0.6 * (hull * math.pi * 0.25**2 + 1.17 * 0.4 * 0.03)
    at_one = drag.linear_drag.force.vector[0] + drag.quadratic_drag.force.vector[0]
    # Two terms cannot follow the root of friction exactly: 10 %
    assert at_one == pytest.approx(by_hand, rel=0.1)


def test_what_is_not_given_is_marked_as_assumed(tmp_path: Path) -> None:
    write_vehicle(tmp_path)
    content = load_yaml(tmp_path / 'mine.yaml')
    assert content['hull']['length']['source'] == 'given to lta vehicle new'
    for place in (content['layers']['hull']['envelope']['mass'], content['trim']['heaviness'],
                  content['aero']['quadratic_drag']['force']):  # fmt: skip
        assert place['source'].startswith('assumed')
    assert content['aero']['quadratic_drag']['force']['range'][1][0] > 0.0


@pytest.mark.parametrize('motors', [2, 3, 4])
def test_it_flies_with_the_gains_beside_it(tmp_path: Path, motors: int) -> None:
    write_vehicle(tmp_path, motors=motors)
    assert validate_vehicle_file(tmp_path / 'mine.yaml').faults == []
    loop = build_loop(load_spec(str(tmp_path / 'mine.yaml'), 'lamp_room', 'bag', ''), 1)
    for _ in range(400):
        loop.step()
    # The climb has begun where a motor pushes up
    assert (max(loop.duties) > 0.05) == (motors > 2)


@pytest.mark.long
@pytest.mark.parametrize(
    'size',
    [{}, {'length': 1.0, 'diameter': 0.41, 'mass': 0.09, 'arm': 0.1, 'thrust': 0.15},
     {'length': None, 'height': 0.6, 'diameter': 1.0, 'mass': 0.2, 'motors': 4, 'thrust': 0.15}],
)  # fmt: skip
def test_it_reaches_the_lamp(tmp_path: Path, size: dict[str, float]) -> None:
    write_vehicle(tmp_path, **size)
    loop = build_loop(load_spec(str(tmp_path / 'mine.yaml'), 'lamp_room', 'bag', ''), 1)
    *_, last = loop.iterate_steps()
    assert last.name == 'REACHED'


def test_a_heavy_vehicle_is_carried_by_its_motors(tmp_path: Path) -> None:
    vehicle = write_vehicle(tmp_path, mass=0.155)
    assert vehicle.heaviness == pytest.approx(0.155 - vehicle.gross_lift, abs=1e-4)
    assert vehicle.ballast_mass == 0.0


def test_a_file_that_exists_is_kept_and_nothing_written(tmp_path: Path) -> None:
    (tmp_path / 'mine.gains.yaml').write_text('kept')
    with pytest.raises(BadInput, match='already exists'):
        write_vehicle(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ['mine.gains.yaml']


def test_its_command_has_units_and_sizes_are_no_truths() -> None:
    sizes = {'mass': 0.12, 'thrust': '100 mN', 'arm': 0.07, 'battery': '0.25 Ah'}
    request = NewVehicleRequest(name='mine', diameter='50 cm', **sizes)
    assert request.format_command() == (
        "lta vehicle new mine --diameter '0.5 m' --mass '120 g' --thrust '0.1 N' --arm '0.07 m' "
        "--battery '250 mA h'"
    )
    with pytest.raises(ValidationError, match="'True' is not a length"):
        NewVehicleRequest(name='mine', diameter=True)


def test_a_folder_is_no_vehicle_file() -> None:
    """The path `.` has no file name, from which the name of the gains file is derived."""
    size = VehicleSize(diameter=0.5, length=1.2, mass=0.12, motors=3, thrust=0.1, arm=0.2)
    with pytest.raises(BadInput, match='is a folder; name a file'):
        write_sized_vehicle('mine', size, Path())


def test_the_command_says_what_it_wrote_and_what_next(call, tmp_path: Path) -> None:
    path = tmp_path / 'mine.yaml'
    status, said = call('vehicle', 'new', 'mine', *CIGAR, '--file', str(path))
    assert status == 0
    assert '34 g of ballast leave it 2 g heavier' in said.out
    assert 'tests plan' in said.out
    assert call('vehicle', 'new', 'mine', *CIGAR, '--file', str(path))[0] == 2
    status, said = call('vehicle', 'new', 'other', '--mass', '30 g')
    assert status == 2
    assert 'add --diameter, --thrust, --arm, or' in said.err
    status, said = call('vehicle', 'new', 'other', '--mass', '30 g', '--from', 'gtmab')
    assert status == 2
