"""Print how the energy of flights of a mission agrees with the full loop: [starts] [seeds]."""

import sys

import add_paths  # noqa: F401
from leg_validation import compare_leg_with_loop
from lta_config.schema.mission_file import load_mission
from lta_studies.mission.scene import MissionScene
import numpy as np


def main():
    """Print the comparison: `mission.py [starts] [seeds]`."""
    count, seeds = ([int(word) for word in sys.argv[1:]] + [20, 5][len(sys.argv) - 1 :])[:2]
    scenes = MissionScene(load_mission('warehouse'))
    rows, powers = [], []
    for start, leg, loop in compare_leg_with_loop(scenes, 'aisle', count, seeds):
        a, b = np.median(leg, axis=0), np.median(loop, axis=0)
        rows.append((a[0], b[0]))
        powers.append((leg[:, 0].sum() / leg[:, 1].sum(), loop[:, 0].sum() / loop[:, 1].sum()))
        words = f'{start.charge:.2f} charge  leg {a[0]:7.2f} J {a[1]:6.1f} s'
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
