"""What was learned stands in the vehicle file, and flies as it was learned."""

from types import SimpleNamespace

from lta_config.files import find_file, parse_yaml
from lta_discovery.finding import (
    ChannelErrors,
    NamedEffect,
    ParameterEstimate,
    StudyResult,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.results.learned_file import add_validity, format_learned_vehicle
from lta_model.vehicle import load_vehicle
from lta_vehicle.difference import compare_vehicles
import numpy as np
import pytest


def _finding(effects=(), vehicle='gtmab', added=0.5):
    """Return a study whose effects add that to fitted tolerances, give or take 0.1."""
    bags = {'train': ('A',), 'confirm': ('B',), 'holdout': ('C',)}
    gap = ChannelErrors(
        'position', 'm', 5.0, 0.3, 0.2, 0.1, 1.0, 0.002, 0.67, (0.6, 0.7), 9,
        added_ci95=(added - 0.1, added + 0.1),
    )  # fmt: skip
    return StudyResult(
        'named', effects, (), (), (gap,), True, (), (), 1, bags, vehicle, {'commit': 'abc123'}
    )


def _turned(nominal, names):
    """Return the vehicle with some knobs turned, each by a part of what is typical of it."""
    by_name = {knob.name: knob for knob in list_free_parameters(nominal)}
    for name in names:
        knob = by_name[name]
        value = min(max(0.3 * knob.typical, knob.low), knob.high)
        nominal = knob.apply_to(nominal, value or max(-0.3 * knob.typical, knob.low))
    return nominal


def _written(vehicle, path, names, finding=None):
    """Return a vehicle, what was learned of it, and both of the file that says so."""
    text = find_file('vehicle', vehicle).read_text(encoding='utf-8')
    known = load_vehicle(vehicle)
    nominal = NominalVehicle.from_vehicle(known)
    learned = _turned(nominal, names)
    path.write_text(format_learned_vehicle(text, known, nominal, learned, finding or _finding()))
    return known, learned, load_vehicle(str(path))


@pytest.mark.parametrize(  # of revolution about z, and a sphere
    'vehicle', ['gtmab', pytest.param('skye', marks=pytest.mark.long)]
)
def test_every_candidate_has_its_place_in_the_file(vehicle, tmp_path):
    turnable = [
        k.name
        for k in list_free_parameters(NominalVehicle.from_vehicle(load_vehicle(vehicle)))
        if k.typical
    ]
    # Those that would make it too heavy to be a vehicle, all at once, are tried one by one.
    heavy = {'ballast.mass', 'payload.mass', 'gas_purity.purity', 'cg_height.z'}
    for names in ([n for n in turnable if n not in heavy], *([n] for n in turnable if n in heavy)):
        _, learned, back = _written(vehicle, tmp_path / 'vehicle.yaml', names)
        again = NominalVehicle.from_vehicle(back)
        for effect, given in learned.effect_parameters.items():
            for name, value in given.items():
                assert again.parameter_value(effect, name) == pytest.approx(
                    value, rel=1e-9, abs=1e-12
                )


def test_nothing_learned_leaves_the_file_as_it_is():
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    known = load_vehicle('gtmab')
    same = NominalVehicle.from_vehicle(known)
    assert format_learned_vehicle(text, known, same, same, _finding()) == text


def test_the_source_has_interval_flights_commit_and_what_was_before(tmp_path):
    told = ParameterEstimate('surge', 'N s/m', 0.0, 0.003, (0.002, 0.004))
    effect = NamedEffect('linear_drag', ('linear_drag.surge',), (told,), 40.0)
    path = tmp_path / 'vehicle.yaml'
    _, _, back = _written('gtmab', path, ['linear_drag.surge'], _finding((effect,)))
    drag = back.file.aero.linear_drag.force
    assert drag.vector == pytest.approx((0.003, 0.0, 0.0))
    for words in ('surge 0.003 N s/m, 95 % 0.002 to 0.004', 'from A, B, commit abc123',
                  'previously [0, 0, 0] N s/m (CFD: drag is quadratic at 0.2 to '
                  '2 m/s)'):  # fmt: skip
        assert words in drag.source
    # As a law is fitted beside an effect that no forecast shows, its file holds it as what it is
    _, _, back = _written('gtmab', path, ['linear_drag.surge'], _finding((effect,), added=0.0))
    assert 'surge possible, not named: 0.003 N s/m' in back.file.aero.linear_drag.force.source


def test_the_difference_of_both_files_is_what_was_learned(tmp_path):
    names = ['tracker_delay.delay', 'linear_drag.heave']
    before, _, after = _written('gtmab', tmp_path / 'vehicle.yaml', names)
    assert [change.place for change in compare_vehicles(before, after).changes] == [
        'aero.linear_drag.force', 'effects.tracker_delay.delay',
    ]  # fmt: skip


def test_discoveries_chain(tmp_path):
    first = tmp_path / 'first.yaml'
    _, learned, back = _written('gtmab', first, ['linear_drag.surge', 'added_mass.heave'])
    _, twice, again = _written(str(first), tmp_path / 'second.yaml', ['linear_drag.surge'])
    assert NominalVehicle.from_vehicle(back).parameter_value(
        'linear_drag', 'surge'
    ) == pytest.approx(0.003)
    assert twice.parameter_value('linear_drag', 'surge') == pytest.approx(0.006)
    assert NominalVehicle.from_vehicle(again).parameter_value(
        'linear_drag', 'surge'
    ) == pytest.approx(0.006)
    heave = learned.parameter_value('added_mass', 'heave')
    assert NominalVehicle.from_vehicle(again).parameter_value(
        'added_mass', 'heave'
    ) == pytest.approx(heave)


def test_the_region_of_flights_by_force_has_no_duties() -> None:
    """Their duties are zeros that nobody commanded: any flight by duties would be outside."""

    def flown(duties, wrench):
        start = np.zeros((3, 13))
        start[:, 6], start[:, 7] = 1.0, (0.2, 0.3, 0.5)
        flight = SimpleNamespace(wrench=wrench, commands=SimpleNamespace(values=np.array(duties)))
        return SimpleNamespace(
            replay=SimpleNamespace(cut=SimpleNamespace(start=start), flight=flight)
        )

    text = find_file('vehicle', 'rgblimp').read_text(encoding='utf-8')
    names = load_vehicle('rgblimp').rotor_names
    by_force = flown([[0.0, 0.0]], object())
    by_duty = flown([[0.3, 0.6], [0.4, 0.9]], None)
    region = parse_yaml(add_validity(text, [by_force], names, 'a test'), 'a test')['validity']
    assert region['speed']['value'] == [0.2, 0.5]
    assert 'commands' not in region
    both = parse_yaml(add_validity(text, [by_force, by_duty], names, 'a test'), 'a test')
    commands = both['validity']['commands']
    assert [commands[name]['value'] for name in names] == [[0.3, 0.4], [0.6, 0.9]]
