# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Name parameters and tests in words of a laboratory."""

from collections.abc import Sequence
import math
from typing import Final

from lta_discovery.formatting import format_number, format_parameter, join_words, TO_DEG
from lta_discovery.lab_tests.design import LabTest

# Words of effects whose parameters are axes; {} are the axes
EFFECT_AXIS_WORDS: Final = {
    'wrench_gain': 'gain in {}',
    'rotational_drag': 'damping in {}',
    'quadratic_drag': 'drag in {}',
    'linear_drag': 'drag in {}',
    'added_mass': 'added mass in {}',
    'added_inertia': 'added inertia in {}',
    'marker_offset': 'marker frame ({})',
    'tracker_misalignment': 'tilt of the tracker ({})',
    'rotor_misalignment': 'toe of the rotors',
    'cg_offset': 'balance ({})',
}
LAW_WORDS: Final = {
    'exponent': 'exponent of the thrust in {}',
    'reverse': 'thrust in reverse in {}',
}
PLAIN_WORDS: Final = {
    'cg_height.z': 'height of the centre of gravity',
    'helium_leak.rate': 'loss of lift',
    'vehicle.mass': 'mass',
}
STEP_DIRECTION_WORDS: Final = {
    ('surge', 1.0): 'forward', ('surge', -1.0): 'backward', ('sway', 1.0): 'to the left',
    ('sway', -1.0): 'to the right', ('heave', 1.0): 'up', ('heave', -1.0): 'down',
    ('yaw', 1.0): 'to the left', ('yaw', -1.0): 'to the right',
}  # fmt: skip


def name_parameters(names: Sequence[str], rotors: Sequence[str]) -> list[str]:
    """Return parameters in words, those of one effect together, in the order of the first."""
    groups: dict[str, list[str]] = {}
    for name in names:
        effect, _, part = name.partition('.')
        if effect == 'vehicle' and part != 'mass':
            words, axis = 'inertia in {}', part
        elif '_from_' in part:
            acting, _, axis = part.removesuffix('_size').partition('_from_')
            words = acting + ' by the command in {}'
        elif effect == 'wrench_gain' and '_' in part:
            kind, _, axis = part.partition('_')
            words = LAW_WORDS[kind]
        elif effect in EFFECT_AXIS_WORDS:
            words, axis = EFFECT_AXIS_WORDS[effect], part.removesuffix('_2')
        elif effect.startswith('rotor_') and part == 'thrust':
            words = 'thrust of {}'
            axis = rotors[int(effect.rpartition('_')[2]) - 1].replace('_', ' ')
        else:
            words, axis = PLAIN_WORDS.get(name, format_parameter(name)), ''
        if axis not in groups.setdefault(words, []):
            groups[words].append(axis)
    return [words.format(join_words(axes)) for words, axes in groups.items()]


def format_amplitude(test: LabTest, rotors: Sequence[str], duties: Sequence[float]) -> str:
    """Return what is commanded, or how the vehicle is let go."""
    degrees = f'{TO_DEG * test.tilt:.0f} degrees'
    if test.kind == 'swing':
        return f'released from {degrees}; once more from {TO_DEG * test.tilt / 4.0:.0f}'
    if test.kind == 'spin_down':
        return f'turned by hand to {TO_DEG * test.rate:.0f} degrees/s'
    if test.kind == 'float':
        return 'released at rest'
    if test.kind == 'free_flight':
        return 'commands of several sizes that change every second or two, on all axes at once'
    unit = 'mN m' if test.axis == 'yaw' else 'mN'
    side = STEP_DIRECTION_WORDS[test.axis, math.copysign(1.0, test.size)]
    force = f'{format_number(1e3 * abs(test.size), 2)} {unit} {side}'
    if not duties:
        return force
    each = ', '.join(
        f'{name.replace("_", " ")} {duty:.2f}'
        for name, duty in zip(rotors, duties, strict=True)
        if abs(duty) > 0.005
    )
    return f'{force} (duties {each})'


def format_instruction(test: LabTest) -> str:
    """Return what to do, as a request."""
    seconds = f'{test.seconds:.0f} s'
    if test.kind == 'swing':
        return f'let it swing in {test.axis} for {seconds} from {TO_DEG * test.tilt:.0f} degrees'
    if test.kind == 'float':
        return f'let it float without commands for {seconds}'
    if test.kind == 'spin_down':
        rate = f'{TO_DEG * test.rate:.0f} degrees/s'
        return f'turn it by hand to {rate}, and let it turn for {seconds}'
    if test.kind == 'free_flight':
        return (
            f'fly for {seconds} with commands of several sizes on all axes, which change every '
            'second or two'
        )
    return f'command {format_amplitude(test, (), ())} for {seconds}'
