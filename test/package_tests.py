# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Which unit tests belong to which package: what `colcon test` runs.

A path below test/unit belongs to the package of its longest match here.
"""

from pathlib import Path
from typing import Final

UNIT: Final = Path(__file__).resolve().parent / 'unit'
PACKAGE_TESTS: Final = {
    'lta_analysis': (
        'data/bag/test_table.py',
        'data/compare/test_pairs.py',
        'data/compare/test_scene.py',
        'data/compare/test_verb.py',
        'data/plot',
        'flight/test_notebook_calls.py',
    ),
    'lta_bag': ('bag',),
    'lta_bridge': ('bridge',),
    'lta_bringup': ('graph/test_bringup.py',),
    'lta_cli': ('cli', 'security'),
    'lta_config': ('config', 'sim/test_flat.py', 'sim/test_kernel_cache.py'),
    'lta_control': ('control',),
    'lta_data': ('data',),
    'lta_discovery': ('discovery',),
    'lta_emulation': (
        'bridge/crazyflie/test_crazyflie_flight.py',
        'bridge/crazyflie/test_emulated.py',
        'bridge/crazyflie/test_firmware_bench.py',
        'bridge/crazyflie/test_firmware_contract.py',
        'bridge/crazyflie/test_noise.py',
    ),
    'lta_energy': ('energy',),
    'lta_flight': ('flight',),
    'lta_graph': ('graph',),
    'lta_model': (
        'energy/test_battery.py',
        'energy/test_battery_pybamm.py',
        'energy/test_loads.py',
        'energy/test_panel.py',
        'energy/test_power_path.py',
        'sim/test_boundaries.py',
        'sim/test_effects.py',
        'sim/test_hull_aerodynamics.py',
        'sim/test_imu.py',
        'sim/test_lambertian.py',
        'sim/test_light_block.py',
        'sim/test_light_field.py',
        'sim/test_mass.py',
        'sim/test_measurement_effects.py',
        'sim/test_pressure.py',
        'sim/test_range.py',
        'sim/test_reflected_light.py',
        'sim/test_rotors.py',
        'sim/test_scenario.py',
        'sim/test_several_lamps.py',
        'sim/test_wind_effects.py',
    ),
    'lta_report': ('report',),
    'lta_sim': ('sim',),
    'lta_studies': ('studies',),
    'lta_vehicle': ('vehicle',),
    'lta_vlc': ('vlc',),
    'lta_windtunnel': ('windtunnel',),
    # Shared, or of tools and campaigns, which `make test` alone runs
    '': (
        'campaigns',
        'conftest.py',
        'report_flight.py',
        'test_build.py',
        'test_same.py',
    ),
}


def find_package(path: Path) -> str:
    """
    Return the package that a file below test/unit belongs to; '' for none.

    Raises
    ------
    LookupError
        If the table has no place for the file.

    """
    places = {UNIT / place: name for name, paths in PACKAGE_TESTS.items() for place in paths}
    for place in (path, *path.parents):
        if place in places:
            return places[place]
    raise LookupError(f'{path} belongs to no package; add it to {__file__}.')


def list_files(package: str) -> list[Path]:
    """Return the tests of a package and the modules beside them."""
    return [path for path in sorted(UNIT.rglob('*.py')) if find_package(path) == package]


def list_tests(package: str) -> list[Path]:
    """Return the test files of a package."""
    return [path for path in list_files(package) if path.name.startswith('test_')]
