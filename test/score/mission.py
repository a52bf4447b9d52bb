"""
Compare flights of a mission with the full loop: the same vehicle, scene, start and charge.

Each flight goes from rest to the moment at which homing takes itself to have arrived, once by the
compiled leg and once by `lta_analysis.loop` with its ADC blocks, whose chance is another.
So the median over some seeds stands for a flight.
"""

from dataclasses import replace
import math
import sys

from lta_analysis.loop import Loop
from lta_analysis.mission.aloft import at_rest, GO, Leg
from lta_analysis.mission.legs import Pilot
from lta_analysis.mission.scene import Scenes
from lta_config.mission_file import load_mission
from lta_config.quantity import Quantity
from lta_config.topics import topic_table
from lta_control.mission import Phase
from lta_energy.light_of_days import DARK
from lta_sim.world import World
import numpy as np

LIMIT = 200.0  # s
BEACON = 'aisle'


def starts(count):
    """Return place, heading and charge of each flight: 3 to 8 m off, all round."""
    for k in range(count):
        away, side = 3.0 + 5.0 * ((k * 0.618) % 1.0), 2.0 * math.pi * ((k * 0.414) % 1.0)
        yield away, side, side + math.pi + 0.5 * math.sin(2.0 * k), 0.4 + 0.55 * ((k * 0.733) % 1)


def by_leg(scenes, start, seed):
    """Return energy out of the cell [J] and time [s] of a leg."""
    (x, y, heading, charge) = start
    made = scenes.made(BEACON, DARK, 1.0)
    length, width, height = scenes.scenario.room.size.vector
    leg = Leg(GO, LIMIT, 0.0, 0.0, 1.0, 0.0, length / 2, width / 2, height)
    pilot = Pilot(made, leg)
    state = pilot.standing(x, y, scenes.vehicle.standing_height, heading, seed)
    memory, _ = pilot.fly(pilot.constants(made), leg, at_rest(charge, charge), state, seed)
    return memory.flow.consumed - memory.flow.harvested, memory.step * 0.01


def by_loop(scenes, start, seed):
    """Return the same of the full loop."""
    (x, y, heading, charge) = start
    begin = scenes.scenario.start.model_copy(
        update={
            'position': Quantity(value=(x, y), unit='m'),
            'heading': Quantity(value=heading, unit='rad'),
            'heading_spread': Quantity(value=0.0, unit='rad'),
            'charge': Quantity(value=charge, unit='1'),
        }
    )
    lamp = scenes.scenario.lamps[BEACON]
    scene = scenes.scenario.model_copy(
        update={'several': {BEACON: lamp}, 'alone': None, 'route': (), 'start': begin}
    )
    made = scenes.made(BEACON, DARK, 1.0)
    homing = scenes.policy.mission.homing.model_copy(
        update={'brightness': made.craft.mission.homing.brightness}
    )
    policy = replace(
        scenes.policy,
        mission=scenes.policy.mission.model_copy(update={'homing': homing}),
        demodulation=scenes.policy.demodulation.model_copy(
            update={'frequency': lamp.frequency.si}
        ),
        energy=scenes.policy.energy.model_copy(update={'reserve': 0.0, 'hysteresis': 0.0}),
    )
    loop = Loop(World(scenes.vehicle, scene, topic_table(), seed), topic_table(), policy)
    energy = 0.0
    while loop.mission.phase is not Phase.ARRIVED and loop.world.elapsed < LIMIT:
        loop.step()
        voltage, current = loop.world.supply.electrics
        energy -= voltage * current * 0.01
    return energy, loop.world.elapsed


def compare(count, seeds):
    """Yield start, energies and times by leg, and by loop, over seeds, shape (seeds, 2)."""
    scenes = Scenes(load_mission('warehouse'))
    lamp = scenes.lamp(BEACON).position
    for away, side, heading, charge in starts(count):
        x, y = lamp[0] + away * math.cos(side), lamp[1] + away * math.sin(side)
        start = (x, y, heading, charge)
        yield (
            start,
            np.array([by_leg(scenes, start, seed) for seed in range(seeds)]),
            np.array([by_loop(scenes, start, seed) for seed in range(seeds)]),
        )


def main():
    """Print the comparison: `mission.py [starts] [seeds]`."""
    count, seeds = ([int(word) for word in sys.argv[1:]] + [20, 5][len(sys.argv) - 1 :])[:2]
    rows, powers = [], []
    for start, leg, loop in compare(count, seeds):
        a, b = np.median(leg, axis=0), np.median(loop, axis=0)
        rows.append((a[0], b[0]))
        powers.append((leg[:, 0].sum() / leg[:, 1].sum(), loop[:, 0].sum() / loop[:, 1].sum()))
        words = f'{start[3]:.2f} charge  leg {a[0]:7.2f} J {a[1]:6.1f} s'
        sys.stdout.write(f'{words}  loop {b[0]:7.2f} J {b[1]:6.1f} s  {a[0] / b[0] - 1:+.2%}\n')
    found, power = np.array(rows), np.array(powers)
    off = found[:, 0] / found[:, 1] - 1.0
    whole, mean = (each[:, 0].sum() / each[:, 1].sum() - 1.0 for each in (found, power))
    sys.stdout.write(
        f'all flights together {whole:+.2%}; one {np.median(abs(off)):.2%} at the median, '
        f'{abs(off).max():.2%} at most; mean power {mean:+.2%}\n'
    )


if __name__ == '__main__':
    main()
