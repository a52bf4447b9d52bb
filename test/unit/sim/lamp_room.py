# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worlds of the shipped vehicle in the shipped room, with other numbers where wanted."""

import copy

from lta_config.files import find_file, load_yaml, share_folder
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.topics import TopicTable
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.world import World

G = 9.80665
OFF = (0.0, 0.0, 0.0, 0.0)
HOVER = (0.12844, 0.12844, 0.0, 0.0)
TOPICS = load_yaml(share_folder() / 'topics.yaml')
ROOM = load_yaml(find_file('scenario', 'lamp_room'))
GTMAB = load_yaml(find_file('vehicle', 'gtmab'))
START = 1_000_000_000
STEP = 10_000_000


def edited(content, changes):
    content = copy.deepcopy(content)
    for place, value in changes.items():
        *way, last = place.split('/')
        part = content
        for key in way:
            part = part[key]
        part[last] = value
    return content


def build(seed=1, scene=None, topics=None, vehicle=None, strategy=''):
    scenario = Scenario.model_validate(edited(ROOM, scene or {}))
    file = VehicleFile.model_validate(edited(GTMAB, vehicle or {}))
    table = TopicTable.model_validate(edited(TOPICS, topics or {}))
    return World(Vehicle(file, scenario.air.density), scenario, table, seed, strategy)


def fly(world, steps, duties=OFF):
    """Return the readings of so many control steps."""
    out = []
    for _ in range(steps):
        out.append(world.sense())
        world.advance(duties)
    return out
