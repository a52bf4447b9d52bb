# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Small halls for the tests of `lta light plan`."""

from lta_config.topics import load_topic_table
from lta_model.vehicle import load_vehicle
from lta_studies.light.plan.floor import build_floor, FloorPlan
from lta_studies.light.plan.joint_snr import LightReceiver
from lta_studies.light.plan.planner import list_mounts, plan_layout
from lta_vlc.settings import DemodulationSettings
import yaml

HALL = """
schema: 1
name: test
about: A hall.
outline: {x: {value: [0, 12, 12, 0], unit: m}, y: {value: [0, 0, 12, 12], unit: m}}
height: 5 m
albedo: 0.5
altitude: 2 m
lamp: {flux: 10000 lm, half_power: 60 deg, efficacy: 300 lm/W, duty: 50 %, height: 1.67 m,
  facing: sideways, spacing: 3 m}
ambient: {steady: 100 lx, mains_amplitude: 0 lx, mains_frequency: 100 Hz, efficacy: 300 lm/W}
"""


def rectangle(west, south, east, north):
    """Return an area as a file has it [m]."""
    return {
        'x': {'value': [west, east, east, west], 'unit': 'm'},
        'y': {'value': [south, south, north, north], 'unit': 'm'},
    }


def content(**changes):
    """Return what the file of a hall holds, with other blocks; keys of `lamp` one by one."""
    lamp = changes.pop('lamp', {})
    hall = yaml.safe_load(HALL) | changes
    return hall | {'lamp': hall['lamp'] | lamp}


def hall(**changes):
    """Return a hall; parameters as `content`."""
    return FloorPlan.model_validate(content(**changes))


def ear(margin=2.0, **settings):
    """Return GT-MAB listening."""
    return LightReceiver(
        load_vehicle('gtmab'), DemodulationSettings(**settings), load_topic_table().light, margin
    )


def laid_out(plan, cell=0.5, overlap=1, most=None, listener=None):
    """Return the layout of a hall."""
    who = listener or ear()
    floor = build_floor(plan, who.vehicle, cell)
    return plan_layout(plan, who, floor, list_mounts(plan), overlap, most)
