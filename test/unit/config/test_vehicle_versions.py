"""Vehicle files of versions 1 and 2 are read as what they meant."""

import copy

from lta_config.errors import BadInput
from lta_config.schema.cell_file import load_cell_file
from lta_config.schema.vehicle_file import load_vehicle_file
import pytest
import yaml

from .changed_vehicle import GTMAB, without

FLAT = {
    'capacity': {'value': 250, 'unit': 'mA h', 'source': 'test'},
    'resistance': {'value': 0.15, 'unit': 'ohm', 'source': 'test'},
    'idle': {'value': 97, 'unit': 'mW', 'source': 'test'},
    'transmitting': {'value': 23, 'unit': 'mW', 'source': 'test'},
    'rotor_idle': {'value': 27, 'unit': 'mW', 'source': 'test'},
    'rotor_power': {'value': 23.96, 'unit': 'W/N', 'source': 'test'},
    'panel_area': {'value': 139, 'unit': 'cm2', 'source': 'test'},
    'panel_efficiency': {'value': 20, 'unit': '%', 'source': 'test'},
    'panel_voltage': {'value': 4.4, 'unit': 'V', 'source': 'test'},
}


def version_2():
    """Return GT-MAB as version 2 of the format had it."""
    old = copy.deepcopy(GTMAB) | {'schema': 2, 'energy': copy.deepcopy(FLAT)}
    old['sensors']['panel_position'] = copy.deepcopy(
        old['layers']['top']['solar_panels']['position']
    )
    return old


def test_version_2_is_read(tmp_path):
    path = tmp_path / 'old.yaml'
    path.write_text(yaml.safe_dump(version_2(), sort_keys=False))
    old, new = load_vehicle_file(str(path)), load_vehicle_file('gtmab')
    assert old.parts == new.parts
    assert old.panel_place == new.panel_place == (0.0, 0.0, 0.302)
    assert old.panel_normal == new.panel_normal == (0.0, 0.0, 1.0)
    energy = old.energy
    assert (energy.battery.capacity.si, energy.battery.resistance.si) == (900.0, 0.15)
    assert energy.battery.relaxation_resistance.si == 0.0
    assert energy.battery.charge_current.si == pytest.approx(0.25)  # 1 C
    assert energy.loads.rotor_power.si == 23.96
    # 139 cm2 of 20 % give 2.78 W in 1000 W/m2, and so do 139 cells of 1 cm2.
    assert energy.array.parallel == 139
    assert energy.array.parallel * load_cell_file(energy.array.cell).rated_power == pytest.approx(
        2.78
    )
    assert (energy.charger.tracking.si, energy.charger.idle.si) == (1.0, 0.0)


def test_version_2_without_a_panel_has_none(tmp_path):
    old = version_2()
    old['energy']['panel_area']['value'] = 0
    path = tmp_path / 'old.yaml'
    path.write_text(yaml.safe_dump(old, sort_keys=False))
    energy = load_vehicle_file(str(path)).energy
    assert energy.array is None
    assert energy.charger is None


def version_1():
    """Return GT-MAB as version 1 of the format had it."""
    old = version_2() | {'schema': 1}
    old['parts'] = {n: part for layer in old.pop('layers').values() for n, part in layer.items()}
    del old['hull']['shape'], old['control']
    for rotor in old['rotors'].values():
        del rotor['axis']
    return old


def test_version_1_is_read(tmp_path):
    path = tmp_path / 'old.yaml'
    path.write_text(yaml.safe_dump(version_1(), sort_keys=False))
    old, new = load_vehicle_file(str(path)), load_vehicle_file('gtmab')
    assert old.parts == new.parts
    assert list(old.parts) == list(new.parts)
    for name, rotor in new.rotors.items():
        assert old.rotors[name].axis.vector == rotor.axis.vector
        assert old.rotors[name].position == rotor.position
    for key in ('trim', 'hull', 'thrust_curve', 'aero', 'effects'):
        assert getattr(old, key) == getattr(new, key)


def test_a_broken_version_1_is_one_sentence(tmp_path):
    path = tmp_path / 'old.yaml'
    for key, words in (('hull', "'hull' is missing"), ('aero', "'aero' is missing")):
        path.write_text(yaml.safe_dump(without(version_1(), key)))
        with pytest.raises(BadInput, match=words):
            load_vehicle_file(str(path))
    old = version_1()
    del old['aero']['thrust_allocation']['up_left']
    path.write_text(yaml.safe_dump(old))
    with pytest.raises(
        BadInput, match=r'has no entry for the rotor up_left in aero\.thrust_allocation; add'
    ):
        load_vehicle_file(str(path))
