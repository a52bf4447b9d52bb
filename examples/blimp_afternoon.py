# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write the CSV files of an afternoon with an unfamiliar blimp, as a motion-capture room logs them.

    (root=$PWD; . tools/workspace.sh; .venv/bin/python examples/blimp_afternoon.py afternoon)

The blimp is commanded by forces and moments. It comes from the independent simulator in
campaigns/challenge, which shares no code with the models of LTA. It differs from the vehicle file
gtmab by what blimps differ in: 0.3 of the commanded forward force arrives, the pendulum is 40 %
faster, the marker frame is 3 to 15 degrees off, and 0 to 50 mN of lift are different in each
flight.

`afternoon/tests` gets the tests and free flights, `afternoon/unseen` a step and flights that check
the result, and `truth.json` what was hidden.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
import json
import math
from pathlib import Path
import sys

from lta_model.vehicle import load_vehicle
import numpy as np
from scipy.spatial.transform import Rotation

sys.path.append(str(Path(__file__).resolve().parents[1]))

from campaigns.challenge.flight import FlightSimulator, TICK
from campaigns.challenge.sensors import SensorSet
from campaigns.challenge.truth import build_vehicle_truth, VehicleTruth
from campaigns.challenge.wrench_flight import WrenchActuators, WrenchPilot

Draw = np.random.Generator
LOWER = 1.4  # distance of the centre of gravity below the hull centre, relative to the file
LIGHTER = 0.64  # inertia, relative to the file; with LOWER, the pendulum is 1.4 times as fast
SURGE = 0.3  # share of the commanded forward force that arrives
LIFT = 0.05  # N; largest net lift beyond the file's
MARKERS = (3.0, 15.0)  # degrees; rotation of the marker frame
HEAD = 'timestamp_ms,x_mm,y_mm,z_mm,qx,qy,qz,qw,cmd_fx,cmd_fy,cmd_fz,cmd_tau_x,cmd_tau_y,cmd_tau_z'
SURGE_STEP, HEAVE_STEP, YAW_STEP = 0.12, 0.04, 0.0015  # N, N, N m; commanded


class Script:
    """A command that is held from each of some times on: (time, axis, size)."""

    def __init__(self, *steps: tuple[float, int, float]) -> None:
        self.steps = steps

    def initial_duties(self) -> list[float]:
        """Return no command."""
        return [0.0] * 6

    def compute_duties(self, time: float, state: list[float]) -> list[float]:
        """Return the command at a time."""
        out = [0.0] * 6
        for begin, axis, size in self.steps:
            if time >= begin:
                out[axis] = size
        return out


def draw_blimp(draw: Draw) -> VehicleTruth:
    """Return the blimp: the vehicle file with what is hidden."""
    file = build_vehicle_truth(load_vehicle('gtmab'))
    angle = math.radians(draw.uniform(*MARKERS))
    way = draw.standard_normal(3)
    turn = Rotation.from_rotvec(angle * way / np.linalg.norm(way))
    return replace(
        file,
        cg=(0.004, -0.003, LOWER * file.cg[2]),
        inertia=tuple(LIGHTER * each for each in file.inertia),
        drag=tuple(each * draw.uniform(0.8, 1.25) for each in file.drag),
        turn_linear=tuple(each * draw.uniform(0.7, 1.4) for each in file.turn_linear),
        turn_square=tuple(each * draw.uniform(0.7, 1.4) for each in file.turn_square),
        wrench_gains=(SURGE, 1.0, draw.uniform(0.6, 1.1), 1.0, 1.0, draw.uniform(0.5, 1.5)),
        marker_turn=tuple(turn.as_euler('ZYX')),
        marker_arm=tuple(draw.uniform(-0.08, 0.08, 3)),
        delay=draw.uniform(0.0, 0.2),
    )


def release(
    height: float, tilt: float = 0.0, axis: int = 0, rates: Sequence[float] = (0, 0, 0)
) -> list[float]:
    """Return the state of a blimp that is let go: tilted about an axis, or turning [m, rad]."""
    turn = [math.cos(0.5 * tilt), 0.0, 0.0, 0.0]
    turn[1 + axis] = math.sin(0.5 * tilt)
    return [0.0, 0.0, height, 0.0, 0.0, 0.0, *turn, *rates]


def list_tests(blimp: VehicleTruth, seed: int) -> dict[str, tuple[object, list[float], float]]:
    """Return the pilot, the initial state and the length of each test by the name of its file."""
    tilt, file = math.radians(20.0), build_vehicle_truth(load_vehicle('gtmab'))

    def pilot(flight: int) -> WrenchPilot:
        draw = np.random.default_rng([seed, 73, flight])
        return WrenchPilot(file, blimp.wrench_gains, draw)

    return {
        'tests/float.csv': (Script(), release(1.5), 8.0),
        'tests/swing_1.csv': (Script(), release(3.5, tilt, 1), 20.0),
        'tests/swing_2.csv': (Script(), release(3.5, tilt, 0), 20.0),
        'tests/push_1.csv': (Script((1.0, 0, SURGE_STEP)), release(1.5), 9.0),
        'tests/push_2.csv': (Script((1.0, 2, HEAVE_STEP)), release(1.5), 7.0),
        'tests/push_3.csv': (Script((1.0, 5, YAW_STEP)), release(1.5), 7.0),
        'tests/spin.csv': (Script(), release(2.5, rates=(0.0, 0.0, 1.5)), 15.0),
        'tests/flight_1.csv': (pilot(1), release(1.5), 60.0),
        'tests/flight_2.csv': (pilot(2), release(1.5), 60.0),
        'unseen/step.csv': (Script((1.0, 0, 0.8 * SURGE_STEP)), release(1.5), 9.5),
        'unseen/flight_3.csv': (pilot(3), release(1.5), 45.0),
        'unseen/flight_4.csv': (pilot(4), release(1.5), 45.0),
    }


def write_log(
    path: Path, blimp: VehicleTruth, test: tuple[object, list[float], float], draw: Draw
) -> None:
    """Fly a test and write its file."""
    pilot, begin, seconds = test
    path.parent.mkdir(parents=True, exist_ok=True)
    flight = FlightSimulator(blimp, pilot, actuators=WrenchActuators)
    trajectory = flight.simulate_flight(begin, seconds)
    time, poses = SensorSet(trajectory, blimp, 'millisecond', draw).measure_poses()
    newest = np.clip((time / TICK + 1e-6).astype(int), 0, len(trajectory.commands) - 1)
    table = np.column_stack([
        1e3 * time + 5000.0, 1e3 * poses[:, :3], poses[:, 3:], trajectory.commands[newest]
    ])  # fmt: skip
    np.savetxt(path, table, fmt=['%.0f', *['%.2f'] * 3, *['%.6f'] * 4, *['%.5f'] * 6],
               delimiter=',', header=HEAD, comments='')  # fmt: skip


def write_afternoon(folder: Path, seed: int, wanted: Callable[[str], bool] = bool) -> None:
    """Write the files of an afternoon, or those with wanted names."""
    draw = np.random.default_rng([seed, 37])
    blimp = draw_blimp(draw)
    lifts = {}
    for number, (name, test) in enumerate(list_tests(blimp, seed).items()):
        own = np.random.default_rng([seed, 37, number])
        lifts[name] = own.uniform(0.0, LIFT)
        if wanted(name):
            write_log(folder / name, replace(blimp, lift=lifts[name]), test, own)
    hidden = {name: getattr(blimp, name) for name in (
        'cg', 'inertia', 'drag', 'turn_linear', 'turn_square', 'wrench_gains', 'marker_turn',
        'marker_arm', 'delay',
    )}  # fmt: skip
    text = json.dumps({'lifts': lifts, **hidden}, indent=1)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / 'truth.json').write_text(text)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.split('\n\n', maxsplit=1)[0])
    parser.add_argument('folder', type=Path)
    parser.add_argument('--seed', type=int, default=1)
    given = parser.parse_args()
    write_afternoon(given.folder, given.seed)
