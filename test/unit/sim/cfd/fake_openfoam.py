"""
Stands in for OpenFOAM's programs: writes what they would, and fails as it is told.

Called by the name of a program in the folder of a case. `FAKE_FAULT` is "CASE:FAULT".
"""

import os
from pathlib import Path
import re
import signal
import sys

DRAG = 0.05  # N at 1 m/s and 1 kg/m3 on each body


def say(text):
    sys.stdout.write(f'{text}\n')


def main(program):
    case = Path('name').read_text().strip()
    with Path('calls').open('a') as calls:
        calls.write(f'{program}\n')
    wanted, _, fault = os.environ.get('FAKE_FAULT', '').partition(':')
    fault = fault if case == wanted else ''
    if fault == 'diverges':
        say('#1  Foam::sigFpe::sigHandler(int)')
        return 136
    if fault == 'killed':
        os.kill(os.getpid(), signal.SIGKILL)
    if fault == 'disk':
        say('write failed: No space left on device')
        return 1
    if program == 'blockMesh':
        Path('constant/polyMesh').mkdir()
    elif program == 'checkMesh':
        say('    cells:  45000\n    Mesh non-orthogonality Max: 42.0 average: 5\n')
    elif program == 'topoSet':
        for name in re.findall(r'name (\w+)_set;', Path('system/topoSetDict').read_text()):
            say(f'    cellZoneSet {name} now size {12 if fault == "coarse" else 59}')
    elif program == 'simpleFoam':
        solve(fault)
    return 0


def solve(fault):
    control = Path('system/controlDict').read_text()
    begin, end = (int(re.search(rf'{key} (\d+);', control)[1]) for key in ('startTime', 'endTime'))
    pushed = re.findall(r'U \(\(([^)]*)\) 0\)', Path('constant/fvOptions').read_text())
    push = [sum(float(each.split()[k]) for each in pushed) for k in range(3)]
    forces = re.findall(r'forces_(\w+)', control)
    bodies = [name for name in forces if name != 'outer']
    still = not re.search('momentum_inlet', control)
    for name in forces:
        drag = 0.0 if name == 'outer' or pushed else DRAG
        rows = [(drag * swing(fault, begin, k), 0.0, 0.0) for k in range(begin, end)]
        write(f'forces_{name}/{begin}/force.dat', begin, rows, 3)
        rows = [tuple(-each for each in spin(row, still)) for row in rows]
        write(f'forces_{name}/{begin}/moment.dat', begin, rows, 3)
    lost = push if pushed else [-DRAG * len(bodies), 0.0, 0.0]
    share = 0.5 if fault == 'unbalanced' else 1.0
    for name in re.findall(r'momentum_(\w+)', control):
        there = [share * each if name in ('outlet', 'far') else 0.0 for each in lost]
        write(f'momentum_{name}/{begin}/surfaceFieldValue.dat', begin, [there] * (end - begin), 1)
    if re.search(r'\bpressure\n', control):
        for name in bodies:
            press(f'pressure/{end}/p_{name}.raw')
    for k in range(begin + 1, end + 1, 20):
        say(f'Time = {k}\nGAMG:  Solving for p, Initial residual = {1 / k}, Final residual = 0')
    say('ExecutionTime = 12.5 s  ClockTime = 13 s')


def press(path):
    """Write a box's pressure: 2 Pa at its top, -1 Pa below, at 1 kg/m3."""
    place = Path('postProcessing') / path
    place.parent.mkdir(parents=True, exist_ok=True)
    ends = (-1, 1)
    rows = [f'{x} {y} {z} {2 if z > 0 else -1}\n' for x in ends for y in ends for z in ends]
    place.write_text('# x y z p\n' + ''.join(rows))


def swing(fault, begin, k):
    """Swing by half from the third speed on, if told."""
    return 1.0 + (0.5 * (-1) ** k if fault == 'swings' and begin >= 420 else 0.0)


def spin(row, still):
    """Brake about each axis alike in still air."""
    return (row[0], row[0], row[0]) if still else (0.0, 0.0, 0.0)


def write(path, begin, rows, times):
    place = Path('postProcessing') / path
    place.parent.mkdir(parents=True, exist_ok=True)
    bracket = [' '.join(f'{each:.6e}' for each in row) for row in rows]
    lines = [
        f'{begin + 1 + k}\t' + '\t'.join([f'({row})'] * times) for k, row in enumerate(bracket)
    ]
    place.write_text('# Time\n' + '\n'.join(lines) + '\n')


if __name__ == '__main__':
    sys.exit(main(Path(sys.argv[1]).name))
