# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Emulate the hardware of a drone in a simulated world (`lta run lta_emulation emulated_hardware`).

One world drives a Crazyflie with CRTP over UDP and a light board with MAVLink on a pseudo
terminal, to test the bridges and all other nodes without hardware. SIGUSR1 unplugs the light
board, and plugs it in again.
"""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
import signal
import sys
import threading
from typing import Any, Final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.crazyflie_file import find_crazyflie, hash_diodes
from lta_config.topics import load_topic_table
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.firmware_bench import FirmwareBench
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_emulation.crazyflie.simulated_body import SimulatedBody
from lta_emulation.teensy.board_server import BoardServer
from lta_emulation.teensy.emulated_board import EmulatedBoard
from lta_graph.terminal_streams import guard_streams
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.world import World

FIRST_PORT: Final = 19850  # first port that cflib scans
# In the working folder: in that of temporary files, any account could be there first
LIGHT_PORT: Final = Path('lta_light_board')
POSITION_PERIOD: Final = 0.1  # s between two checks of the drone's position
TAKEN_OFF_HEIGHT: Final = 0.04  # m above the start, from which on it has taken off


def build_simulated_body(
    vehicle: str,
    scenario: str,
    seed: int,
    light: Callable[[float, Any], None] | None = None,
) -> SimulatedBody:
    """
    Create the simulated body of a Crazyflie.

    `vehicle`, `scenario`: names of shipped files, or paths. `light`: see `SimulatedBody`.
    """
    scene, table = load_scenario(scenario), load_topic_table()
    craft = load_vehicle(vehicle, scene.air.density)
    world = World(craft, scene, table, seed)
    return SimulatedBody(world, find_crazyflie(vehicle, craft.file.name), table, light)


class EmulatedHardware(NamedTuple):
    """The Crazyflie, emulated or as its firmware, the light board, and their world."""

    crazyflie: CrazyflieServer | FirmwareBench
    board: BoardServer
    body: SimulatedBody


@contextmanager
def serve_hardware(
    vehicle: str,
    scenario: str,
    seed: int,
    port: int = 0,
    light_port: Path = LIGHT_PORT,
    beacon: float = 0.0,
    bench_port: int = 0,
) -> Iterator[EmulatedHardware]:
    """
    Serve a drone's hardware while the context lasts.

    Parameters
    ----------
    vehicle, scenario, seed
        As for `build_simulated_body`.
    port : int
        UDP port of the Crazyflie; 0 for any free one.
    light_port : Path
        Path of the light board's port.
    beacon : float
        As for `BoardServer`.
    bench_port : int
        Bench port of the real firmware, which takes the place of the emulated one; 0 for none.

    Raises
    ------
    BadInput
        If a file is wrong, the UDP port is taken, or no firmware answers.

    """
    table, file = load_topic_table(), load_vehicle(vehicle).file
    entry = file.sensors.diodes
    # Booted at time 0 of the board server's clock
    board = EmulatedBoard(
        0, table.light.sample_rate.si, entry.count, bits=entry.bits, vehicle=hash_diodes(file)
    )
    light = BoardServer(board, light_port, beacon)
    body = build_simulated_body(vehicle, scenario, seed, light.sample_light)
    if bench_port:
        with light, FirmwareBench(body, bench_port, port or FIRST_PORT) as firmware:
            yield EmulatedHardware(firmware, light, body)
        return
    try:
        crazyflie = CrazyflieServer(Firmware(body, build=body.build), port)
    except OSError as error:
        raise BadInput(
            f'The UDP port {port} cannot be opened ({error.strerror}); stop the program that uses '
            'it, or give another port with --port.'
        ) from None
    with light, crazyflie:
        yield EmulatedHardware(crazyflie, light, body)


def report_flight(
    body: SimulatedBody, report: Callable[[str], None], wait: Callable[[float], object]
) -> None:
    """
    Report take-off, arrival at the lamp and landing, until `wait` returns true.

    `body`: the drone. `report`: called with each sentence. `wait`: waits for a time [s]; returns
    true to end.
    """
    # Read the world from this thread without a lock: a value of the previous step does not matter
    world = body.world
    floor, began, reached = world.vehicle.hull_height_on_floor, 0.0, False
    while not wait(POSITION_PERIOD):
        up = world.state[2] > floor + TAKEN_OFF_HEIGHT
        if up and not began:
            began, reached = world.elapsed, False
            report(f'The drone took off, {world.goal_distance:.1f} m from the lamp.')
        if up and not reached and world.is_at_lamp:
            reached = True
            report(f'The drone reached the lamp {world.elapsed - began:.1f} s after take-off.')
        if began and not up and not any(body.duties):
            report(f'The drone landed, {world.goal_distance:.1f} m from the lamp.')
            began = 0.0


def _print_line(sentence: str) -> None:
    sys.stdout.write(sentence + '\n')
    sys.stdout.flush()


def main(words: list[str] | None = None) -> None:
    """Serve until interrupted."""
    # Until there is something to close
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    signal.signal(signal.SIGINT, signal.default_int_handler)
    guard_streams()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--port', type=int, default=FIRST_PORT)
    parser.add_argument('--light-port', type=Path, default=LIGHT_PORT)
    parser.add_argument('--beacon', type=float, default=0.0)
    parser.add_argument('--bench-port', type=int, default=0)
    parser.add_argument('--vehicle', default='gtmab')
    parser.add_argument('--scenario', default='lamp_room')
    parser.add_argument('--seed', type=int, default=1)
    options, _ = parser.parse_known_args(words)  # `lta run` adds ROS arguments
    over = threading.Event()
    # End the waiting loop, so that ports and cable are closed
    signal.signal(signal.SIGTERM, lambda *_: over.set())
    try:
        with serve_hardware(
            options.vehicle,
            options.scenario,
            options.seed,
            options.port,
            options.light_port,
            options.beacon,
            options.bench_port,
        ) as hardware:
            kind = 'The firmware' if options.bench_port else 'An emulated Crazyflie'
            _print_line(
                f'{kind} answers at {hardware.crazyflie.uri}, its light board at '
                f'{hardware.board.port}; press Ctrl-C to stop both.'
            )
            signal.signal(signal.SIGUSR1, lambda *_: hardware.board.toggle_cable())
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
            report_flight(hardware.body, _print_line, over.wait)
    except BadInput as error:
        sys.stderr.write(f'{error}\n')
        sys.exit(2)
    except KeyboardInterrupt:
        return
