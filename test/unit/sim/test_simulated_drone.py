# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a simulated drone says of its flight at the end."""

from lta_config.topics import load_topic_table
from lta_graph.health import Health
from lta_sim.drone import DroneSettings, Pacer, SimulatedDrone


def test_a_commanded_flight_that_ends_on_the_ground_has_landed():
    pacer = Pacer(0.01)
    drone = SimulatedDrone(DroneSettings(commanded=True), load_topic_table(), Health())
    ground = drone.world.state[2]
    assert drone.report_flight(pacer)['outcome'] == 'flying'
    drone.world.state[2] = ground + 0.1  # m
    assert drone.report_flight(pacer)['outcome'] == 'flying'
    drone.finish()
    assert drone.report_flight(pacer)['outcome'] == 'flying'
    drone.world.state[2] = ground
    assert drone.report_flight(pacer)['sentence'] == 'on the ground'
    assert drone.report_flight(pacer)['outcome'] == 'landed'


def test_a_drone_that_never_rose_has_not_landed():
    drone = SimulatedDrone(DroneSettings(commanded=True), load_topic_table(), Health())
    drone.finish()
    assert drone.report_flight(Pacer(0.01))['outcome'] == 'flying'
