# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
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
        say('    Patch  Faces  Points  Surface topology')
        for each in Path('constant/triSurface').glob('*.stl'):
            say(f'    {each.stem}  {8 if fault == "lost" else 500}  600  ok (closed)')
    elif program == 'topoSet':
        for name in re.findall(r'name (\w+)_set;', Path('system/topoSetDict').read_text()):
            say(f'    cellZoneSet {name} now size {12 if fault == "coarse" else 59}')
    elif program in ('simpleFoam', 'pimpleFoam'):
        solve(program, fault)
    return 0


def solve(program, fault):
    control = Path('system/controlDict').read_text()
    begin, end = (re.search(rf'{key} ([\d.]+);', control)[1] for key in ('startTime', 'endTime'))
    step = 1.0 if program == 'simpleFoam' else going_on(begin)
    count = int((float(end) - float(begin)) / step + 0.5)
    if count == 0:
        return  # as OpenFOAM does: it ends well and writes nothing
    times = [float(begin) + step * (k + 1) for k in range(count)]
    clock = Path(f'{end}/uniform/time')
    clock.parent.mkdir(parents=True)
    clock.write_text(f'deltaT {step};')
    pushed = re.findall(r'U \(\(([^)]*)\) 0\)', Path('constant/fvOptions').read_text())
    push = [sum(float(each.split()[k]) for each in pushed) for k in range(3)]
    forces = re.findall(r'forces_(\w+)', control)
    bodies = [name for name in forces if name != 'outer']
    still = not re.search('momentum_inlet', control)
    for name in forces:
        drag = 0.0 if name == 'outer' or pushed else DRAG
        rows = [(drag * swing(fault, time), 0.0, 0.0) for time in times]
        write(f'forces_{name}/{begin}/force.dat', times, rows, 3)
        rows = [tuple(-each for each in spin(row, still)) for row in rows]
        write(f'forces_{name}/{begin}/moment.dat', times, rows, 3)
    lost = push if pushed else [-DRAG * len(bodies), 0.0, 0.0]
    share = 0.5 if fault == 'unbalanced' else 1.0
    for name in re.findall(r'momentum_(\w+)', control):
        there = [share * each if name in ('outlet', 'far') else 0.0 for each in lost]
        write(f'momentum_{name}/{begin}/surfaceFieldValue.dat', times, [there] * count, 1)
    if re.search(r'\bpressure\n', control):
        for name in bodies:
            press(f'pressure/{end}/p_{name}.raw')
    for k, time in list(enumerate(times, 1))[::20]:
        say(f'Time = {time:g}')
        say(f'GAMG:  Solving for p, Initial residual = {1 / k}, Final residual = 0')
    say('ExecutionTime = 12.5 s  ClockTime = 13 s')


def press(path):
    """Write a box's pressure: 2 Pa at its top, -1 Pa below, at 1 kg/m3."""
    place = Path('postProcessing') / path
    place.parent.mkdir(parents=True, exist_ok=True)
    ends = (-1, 1)
    rows = [f'{x} {y} {z} {2 if z > 0 else -1}\n' for x in ends for y in ends for z in ends]
    place.write_text('# x y z p\n' + ''.join(rows))


def going_on(begin):
    """Return the step that is gone on with: what the folder of that time says, if anything."""
    clock = Path(f'{begin}/uniform/time')
    told = re.search(r'deltaT ([\d.e-]+);', clock.read_text() if clock.exists() else '')
    return 0.02 if told is None or float(told[1]) < 0.02 else float(told[1])


def swing(fault, time):
    """Swing by half from the third speed on, if told."""
    return 1.0 + (0.5 * (-1) ** round(time) if fault == 'swings' and time > 420 else 0.0)


def spin(row, still):
    """Brake about each axis alike in still air."""
    return (row[0], row[0], row[0]) if still else (0.0, 0.0, 0.0)


def write(path, times, rows, brackets):
    place = Path('postProcessing') / path
    place.parent.mkdir(parents=True, exist_ok=True)
    bracket = [' '.join(f'{each:.6e}' for each in row) for row in rows]
    lines = [
        f'{time:.8g}\t' + '\t'.join([f'({row})'] * brackets)
        for time, row in zip(times, bracket, strict=True)
    ]
    place.write_text('# Time\n' + '\n'.join(lines) + '\n')


if __name__ == '__main__':
    sys.exit(main(Path(sys.argv[1]).name))
