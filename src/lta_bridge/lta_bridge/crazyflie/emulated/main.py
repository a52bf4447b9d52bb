"""`lta run lta_bridge crazyflie_emulated`: a Crazyflie to try the bridge on, without one."""

import argparse
import sys
import threading

from lta_bridge.crazyflie.emulated.firmware import Firmware
from lta_bridge.crazyflie.emulated.flown import Flown
from lta_bridge.crazyflie.emulated.server import Server
from lta_config.crazyflie_file import load_crazyflie
from lta_config.errors import BadInput
from lta_config.topics import topic_table
from lta_sim.scenario import load_scenario
from lta_sim.vehicle import load_vehicle
from lta_sim.world import World


def body(vehicle: str, scenario: str, seed: int) -> Flown:
    """Return a simulated drone on its Crazyflie; names are of shipped files or paths."""
    scene, table = load_scenario(scenario), topic_table()
    world = World(load_vehicle(vehicle, scene.air.density), scene, table, seed)
    return Flown(world, load_crazyflie(vehicle), table)


def main(words: list[str] | None = None) -> None:
    """Serve until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--port', type=int, default=19850)
    parser.add_argument('--vehicle', default='gtmab')
    parser.add_argument('--scenario', default='lamp_room')
    parser.add_argument('--seed', type=int, default=1)
    told, _ = parser.parse_known_args(words)  # `lta run` adds ROS arguments
    try:
        drone = Firmware(body(told.vehicle, told.scenario, told.seed))
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        sys.exit(2)
    with Server(drone, told.port) as server:
        sys.stdout.write(f'An emulated Crazyflie answers at {server.uri}; Ctrl-C ends it.\n')
        sys.stdout.flush()
        try:
            threading.Event().wait()
        except KeyboardInterrupt:
            return
