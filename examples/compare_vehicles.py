# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Seven drones by their files, side by side: no flight, no ROS.

In the environment of LTA:

    (root=$PWD; . tools/workspace.sh; .venv/bin/python examples/compare_vehicles.py)
"""

# %% What follows from every shipped file
from lta_config.files import list_shipped_names
from lta_model.vehicle import load_vehicle
from lta_vehicle.figures.sheet import build_sheet

sheets = [build_sheet(load_vehicle(name)) for name in list_shipped_names('vehicles')]

# %% How much of its mass the air carries, and how many numbers of its file somebody measured
for sheet in sheets:
    figures, entries = sheet.by_key, len(sheet.numbers)
    mass, heavy = figures['mass'].value, figures['heaviness'].value
    carried = 100.0 * (1.0 - heavy / mass)
    measured = entries - sheet.assumed_count
    name = sheet.vehicle.file.name
    print(f'{name:12} {carried:5.1f} % by the air, {measured:3} of {entries} numbers known')
