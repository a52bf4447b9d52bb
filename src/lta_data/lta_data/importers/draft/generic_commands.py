# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
List commands whose names do not say what they drive: `u1`, `tau_2`, `joy_x`, `thrust`.

Three numbers such as `tau1, tau2, tau3` can be a moment, the force ahead with the force up and the
moment about z, or three rotors. The motion decides (`command_motion.py`), else the user.

A mixer on board turns them into duties, so they are a wrench, and no actuators.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
import re
from typing import Any, Final

from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_data.importers.draft.choices import BODY_AXES, DraftChoices
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_names import (
    ACTIONS,
    ACTUATOR_PART_WORDS,
    ACTUATOR_WORDS,
    ANGLE_WORDS,
    AXIS_LETTERS,
    BODY_WORDS,
    ColumnName,
    COMMAND_WORDS,
    JOYSTICKS,
    KIND_WORDS,
    LOOSE_WORDS,
    match_kind,
    match_role,
    needs_translation,
    PLACE_WORDS,
    ROLE_WORDS,
    SERVOS,
    UNIT_WORDS,
    WORD_PATTERN,
)
import numpy as np
from pydantic import ValidationError

LINEAR: Final = frozenset(BODY_AXES[:3])
MOTION_KINDS: Final = ('velocity', 'position', 'rates', 'acceleration', 'euler')
STATE_SETPOINT_WORDS: Final = ROLE_WORDS['setpoint'] - {
    'cmd',
    'command',
    'commanded',
}  # a state, no force
TWIST: Final = frozenset(['linear', 'angular'])
COMMANDING: Final = (
    COMMAND_WORDS | ACTUATOR_WORDS | KIND_WORDS['force'] | KIND_WORDS['torque'] | {'wrench'}
)
# Words beside x, y, z that make it the axis of a command
DRIVING: Final = (COMMAND_WORDS | ACTUATOR_WORDS | {'wrench'}) - ACTUATOR_PART_WORDS
TURNING_LETTERS: Final = (frozenset('t'), frozenset('m'))
OTHER_WORDS: Final = KIND_WORDS['force'] | {'m', 't'}
FRACTION: Final = 1.05  # largest number of a fraction
SMALL_FORCE: Final = 0.3  # a fraction that never exceeds it can be a force of a blimp [N]
COMMAND_UNITS: Final = {'N': 1.0, 'mN': 1e-3, 'N m': 1.0, 'mN m': 1e-3, '%': 0.01}
WRENCH_UNIT_KEY: Final = 'wrench_command.unit'
Columns = Mapping[str, Numbers]


def find_axis_commands(
    names: Sequence[ColumnName], choices: DraftChoices
) -> dict[str, ColumnName]:
    """Return the columns that command a body axis, by axis: by answers, else by their names."""
    by_axis = {
        axis: name
        for name in names
        if (axis := choices.find_answer(f'{name.column}.command')) in BODY_AXES
    }
    rest = [name for name in names if not choices.find_answer(f'{name.column}.command')]
    return find_named_axes(rest, has_linear=bool(LINEAR & {*by_axis})) | by_axis


def find_named_axes(
    names: Sequence[ColumnName], *, has_linear: bool = False
) -> dict[str, ColumnName]:
    """
    Return the columns whose names say that they command a body axis, by axis.

    Roll, pitch and yaw may be angles: they are commands only beside surge, sway or heave, and with
    a word for a command or the other words of these. `has_linear`: one of these is known already.
    """
    by_axis = find_lettered_axes(names)
    names = [name for name in names if name not in by_axis.values()]
    alike: list[frozenset[str]] = []
    read = [(name, *_read_axis(name)) for name in names]
    # Of cmd_left, cmd_right and cmd_up, the last is the place of a rotor
    placed = any(
        name.words & PLACE_WORDS - {*BODY_WORDS} and rest & COMMANDING for name, _, rest in read
    )
    for linear in (True, False):
        for name, axis, rest in read:
            is_command = bool(rest & COMMANDING) or rest in alike
            is_command |= frozenset('f') in alike and rest in TURNING_LETTERS  # t_yaw beside f_up
            if placed and name.words & PLACE_WORDS and name.words & {*BODY_WORDS}:
                continue
            if axis and (axis in LINEAR) is linear and (linear or is_command):
                by_axis.setdefault(axis, name)
                alike += [rest] if linear else []
    angles = [by_axis[axis].words for axis in BODY_AXES[3:] if axis in by_axis]
    if (
        not (has_linear or LINEAR & {*by_axis})
        or angles == [frozenset()] * 3
        or _are_places(by_axis)
    ):
        return {}
    return by_axis


def find_lettered_axes(names: Sequence[ColumnName]) -> dict[str, ColumnName]:
    """Return commands named by the letters of marine craft, as tau_u and tau_r, or X_cmd."""
    families: dict[frozenset[str], dict[str, ColumnName]] = {}
    for name in names:
        words = [
            word.lower() for word in WORD_PATTERN.findall(re.sub(r'[\[(].*', '', name.column))
        ]
        letter = next((word for word in words if len(word) == 1), '')
        families.setdefault(frozenset(words) - {letter}, {})[letter] = name
    forces = KIND_WORDS['force'] | KIND_WORDS['torque'] | {'wrench'}
    either = (frozenset('kmn'), forces | COMMAND_WORDS), (frozenset('u'), forces)
    for rest, family in families.items():
        there = {*family}
        for letters, (needed, allowed) in zip(AXIS_LETTERS, either, strict=True):
            fitting = there <= {*letters} and there & needed and there & {*letters[:3]}
            if rest & allowed and fitting and len(there) > 1:
                return {BODY_AXES[letters.index(one)]: name for one, name in family.items()}
    return {}


def _are_places(commands: Mapping[str, ColumnName]) -> bool:
    """Return whether cmd_x, cmd_y and cmd_z are all there: a place, as a setpoint has it."""
    linear = [commands[axis] for axis in BODY_AXES[:3] if axis in commands]
    return len(linear) == 3 and all(
        name.axis in {*'xyz'} and name.words <= ROLE_WORDS['setpoint'] for name in linear
    )


def _read_axis(name: ColumnName) -> tuple[str, frozenset[str]]:
    """Return the body axis in a name, '' if it is of a motion, and the other words."""
    word = next((word for word in (*name.stem, name.axis) if word in BODY_WORDS), '')
    rest = name.words - {word}
    if rest & COMMAND_WORDS and rest & TWIST:
        rest -= {*TWIST, 'vel', 'twist'}  # cmd_vel.linear.x, which is no velocity of a blimp
    axis = BODY_WORDS.get(word, '') if word not in LOOSE_WORDS or rest & COMMANDING else ''
    turns = name.words & {*KIND_WORDS['torque'], 'angular'}
    driven = turns or (rest & DRIVING and not rest & OTHER_WORDS)
    # What names say to be forces is grouped with those that are measured
    if not word and name.axis in {*'xyz'} and driven and not _list_units([name]):
        axis = BODY_AXES['xyz'.index(name.axis) + (3 if turns else 0)]
    # motor_up is a motor
    axis = (
        '' if word and word not in BODY_AXES and (rest & ACTUATOR_PART_WORDS or not rest) else axis
    )
    measured = match_kind(rest - {'t'}) in MOTION_KINDS or match_role(rest) in (
        'truth',
        'estimate',
    )
    moved = UNIT_WORDS.get(name.unit, ('',))[0] in ('m', 'm/s', 'm/s2', 'rad', 'deg', 'rad/s')
    return ('' if measured or moved or rest & STATE_SETPOINT_WORDS else axis), rest


def draft_axis_commands(
    commands: Mapping[str, ColumnName], table: Columns, choices: DraftChoices
) -> dict[str, Any]:
    """Return the entry of the wrench; its axes are forward, left and up, or those of the log."""
    unit, why = _judge_unit(commands, table, choices)
    entry: dict[str, Any] = {'topic': 'wrench_command'}
    for part, axes, si in (('force', BODY_AXES[:3], 'N'), ('torque', BODY_AXES[3:], 'N m')):
        there = [axis for axis in axes if axis in commands]
        if not there:
            continue
        columns = [commands[axis].column if axis in commands else None for axis in axes]
        vector: dict[str, Any] = {'columns': columns, 'unit': si}
        if unit in ('N', 'mN'):
            own = _list_units(commands[axis] for axis in there)
            named = min(own or {unit}) if WRENCH_UNIT_KEY not in choices.answers else unit
            scale: Any = COMMAND_UNITS[named]
            reading = ', '.join(
                f'{axis} [{named if si == "N" else named + " m"}]' for axis in there
            )
        else:
            full = {axis: _find_largest(axis, si, choices) for axis in there}
            share = COMMAND_UNITS.get(unit, 1.0)
            scale = [float(f'{share * full.get(axis, 0.0):.4g}') for axis in axes]
            reading = ', '.join(f'{axis} of {full[axis]:.3g} {si}' for axis in there)
        if scale != 1.0:
            vector['scale'] = scale
        entry[part] = vector
        lacking = [axis for axis in axes if axis not in there]
        choices.add_reason(
            f'wrench_command: {part}', [one for one in columns if one], reading,
            why + explain_lacking(lacking),
        )  # fmt: skip
    return _place_forces(entry, choices)


def explain_lacking(axes: Sequence[str]) -> str:
    """Return what a reason adds on the axes of a wrench that have no column."""
    return f'; {" and ".join(axes)} without a column: taken as zero' if axes else ''


def _list_units(names: Iterable[ColumnName]) -> set[str]:
    """Return the units in names; those of moments without the metre."""
    units = {UNIT_WORDS.get(name.unit, ('',))[0] for name in names} & {*COMMAND_UNITS}
    return {unit.removesuffix(' m') for unit in units}


def _place_forces(entry: dict[str, Any], choices: DraftChoices) -> dict[str, Any]:
    """Return an entry whose forces act where the rotors of the vehicle file push."""
    centres = {} if choices.vehicle is None else choices.vehicle.centres
    force = entry.get('force', {'columns': []})
    pushed = [axis for axis, column in zip(BODY_AXES, force['columns'], strict=False) if column]
    if not pushed or not {*pushed} <= {*centres}:
        return entry
    # Motors below the hull also turn it, however well their mixer holds the axes apart
    forces = []
    for centre in dict.fromkeys(centres[axis] for axis in pushed):
        columns = [
            column if centres.get(axis) == centre else None
            for axis, column in zip(BODY_AXES, force['columns'], strict=False)
        ]
        at = {'value': [float(f'{x:.3g}') for x in centre], 'unit': 'm'}
        one = {**force, 'columns': columns, 'at': at}
        # Lists of their own, which YAML writes without references
        forces.append({k: [*v] if isinstance(v, list) else v for k, v in one.items()})
    return {'topic': entry['topic'], 'body': 'FLU', 'forces': forces} | {
        name: part for name, part in entry.items() if name == 'torque'
    }


def _judge_unit(
    commands: Mapping[str, ColumnName], table: Columns, choices: DraftChoices
) -> tuple[str, str]:
    """Return the unit of axis commands, or 'fraction', and the reason."""
    named = _list_units(commands.values())
    values = np.concatenate([np.abs(table[name.column]) for name in commands.values()])
    size = float(np.nanmax(values, initial=0.0))
    forces = KIND_WORDS['force'] | KIND_WORDS['torque']
    if named:
        unit, why = min(named), 'the unit in the names'
    elif any(name.words & forces for name in commands.values()):
        unit, why = 'N', 'a word for force in the names'
    elif SMALL_FORCE < size <= FRACTION:
        unit, why = 'fraction', f'up to {size:.3g}: fractions of the largest force of each axis'
    elif FRACTION < size <= 100.0 * FRACTION:
        unit, why = '%', f'up to {size:.3g}: per cent of the largest force of each axis'
    else:
        options = [('fraction', 'of the largest force of each axis'), ('N', 'N, and N m')]
        question = f'Commands of body axes up to {size:.3g} can be fractions or forces.'
        return choices.decide(WRENCH_UNIT_KEY, options, question), choices.explain(WRENCH_UNIT_KEY)
    answer = choices.override(WRENCH_UNIT_KEY, unit)
    if answer not in ('fraction', *COMMAND_UNITS):
        raise BadInput(f"--set {WRENCH_UNIT_KEY} is '{answer}', but must be fraction, %, N or mN.")
    return answer, why if answer == unit else choices.explain(WRENCH_UNIT_KEY)


def _find_largest(axis: str, unit: str, choices: DraftChoices) -> float:
    """Return the force or moment at a command of 1, by the user or by the vehicle file."""
    key = f'{axis}.largest'
    text = choices.override(key, '')
    if text:
        return _parse_force(key, text, unit)
    if choices.vehicle is not None and axis in choices.vehicle.largest:
        return choices.vehicle.largest[axis]
    option = f'0.1 {unit}' if unit == 'N' else f'0.01 {unit}'
    where = 'a vehicle file (--vehicle)' if choices.vehicle is None else 'its vehicle file'
    question = f'No force of {axis} is known at full command. A guess is enough for a calibration'
    question += f', which fits it; {where} states it where rotors push along this axis.'
    answer = choices.decide(key, [(option, 'for example')], question, is_open=True)
    return _parse_force(key, answer, unit)


def _parse_force(key: str, text: str, unit: str) -> float:
    """Return a force or moment that the user gave [N, N m]."""
    try:
        force = Quantity.model_validate(text)
    except ValidationError:
        force = None
    if force is None or force.dimension != unit or not force.si > 0.0:
        raise BadInput(
            f"--set {key} is '{text}', but must be above 0 {unit}, such as '0.1 {unit}'."
        )
    return force.si


VECTOR_WORDS: Final = KIND_WORDS['force'] | KIND_WORDS['torque'] | {'t'}
# Words of a command that name neither its axis nor the actuator
GENERIC_WORDS: Final = (
    COMMAND_WORDS | JOYSTICKS | VECTOR_WORDS | {'u', 'ch', 'channel', 'chan', *ACTIONS}
)
# Of a remote control: what a servo or a rudder turns, only the builder knows
SURFACES: Final = frozenset(['rudder', 'elevator', 'aileron', 'steer', 'steering', *SERVOS])
THRUSTS: Final = frozenset(['thrust', 'throttle', 'thr'])
MEANINGS: Final = {
    'surge': 'the force forward', 'sway': 'the force to the left', 'heave': 'the force up',
    'roll': 'the moment about x', 'pitch': 'the moment about y', 'yaw': 'the moment about z',
}  # fmt: skip
ORDER_WORDS: Final = frozenset(['cmd', 'command', 'commanded'])  # cmd_z may be a height


def list_generic_commands(names: Sequence[ColumnName]) -> list[str]:
    """Return the columns of commands that the motion or the user must tell apart."""
    lettered = find_lettered_axes(names).values()
    names = [name for name in names if name not in lettered]
    generic = {
        name.column
        for names_of in (
            _list_numbered,
            _list_thrusts,
            _list_surfaces,
            _list_orders,
            _list_letters,
        )
        for name in names_of(names)
    }
    return [name.column for name in names if name.column in generic]


def _list_numbered(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield commands with numbers, as u1 to u4, but no force and moment of three numbers each."""
    families: dict[tuple[str, ...], list[ColumnName]] = {}
    for name in names:
        if name.axis.isdigit() and name.stem and {*name.stem} <= GENERIC_WORDS:
            families.setdefault(name.stem, []).append(name)
    vectors = [
        stem for stem, family in families.items() if {*stem} & VECTOR_WORDS and len(family) == 3
    ]
    for stem, family in families.items():
        is_pair = stem in vectors and len(vectors) > 1
        is_six = {*stem} & KIND_WORDS['torque'] and len(family) == 6
        is_place = 't' in stem and needs_translation(names)
        if len(family) > 1 and not (is_pair or is_six or is_place):
            yield from family


def _list_thrusts(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield the one thrust beside commands of body axes, with angles that may be setpoints."""
    others = ACTUATOR_PART_WORDS | PLACE_WORDS | {*BODY_WORDS}
    thrusts = [name for name in names if name.words & THRUSTS and not name.axis
               and not name.words & others]  # fmt: skip
    axes = find_named_axes(names, has_linear=True)
    if len(thrusts) == 1 and axes:
        yield from thrusts
        yield from (name for name in axes.values() if {*name.stem} <= COMMAND_WORDS and name.stem)


def _list_surfaces(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield the one throttle beside a rudder, servo or steering, and these."""
    thrusts = [name for name in names if name.words & THRUSTS and not name.words & PLACE_WORDS]
    surfaces = [
        name for name in names if name.words & SURFACES and name.words <= GENERIC_WORDS | SURFACES
    ]
    if len(thrusts) == 1 and surfaces:
        yield from (*thrusts, *surfaces)


def _list_orders(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield cmd_x or cmd_z, with cmd_yaw, and the axes of a stick."""
    families: dict[tuple[str, ...], list[ColumnName]] = {}
    for name in names:
        families.setdefault(name.stem, []).append(name)
    for stem, family in families.items():
        axes = {name.axis for name in family}
        if {*stem} & JOYSTICKS:
            yield from family
        # All three are a place, as a setpoint has it; u_x, u_y, u_z alone may be a velocity
        partial = {*stem} <= ORDER_WORDS and len(axes & {*'xyz'}) in (1, 2)
        if stem and (partial or (stem == ('u',) and axes == {*'xyz'})):
            yield from (each for each in family if each.axis in {*'xyz', *ANGLE_WORDS.values()})


def _list_letters(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield commands whose letters name no axis, such as u_v and u_h."""
    named = find_named_axes(names).values()
    lettered = [
        name for name in names
        if len(name.stem) == 2 and not name.axis and name not in named
        and name.stem[0] in {*COMMAND_WORDS, 'u'} and len(name.stem[1]) == 1
        and name.stem[1] not in PLACE_WORDS
    ]  # fmt: skip
    if len(lettered) > 1:
        yield from lettered


def ask_for_meanings(columns: Sequence[str], where: str, choices: DraftChoices) -> list[str]:
    """
    Ask what commands drive, unless the user or the motion says it; return the open ones.

    `where`: what follows the name of a column in the question, such as ' of /cmd'.
    """
    rotors = () if choices.vehicle is None else choices.vehicle.rotors
    options = [*MEANINGS.items()]
    options += [(rotor, 'a rotor') for rotor in rotors] or [('NAME', 'of a rotor')]
    options.append(('none', 'nothing that moves the vehicle, or a setpoint'))
    open_ = []
    for column in columns:
        key, follows = f'{column}.command', choices.follows.get(column, '')
        reading = choices.by_motion.get(key) or choices.by_motion.get(f'{column}.topic')
        if choices.answers.get(key):
            continue
        if reading:
            choices.add_reason('commands', [column], reading, follows.strip().rstrip('.'))
        else:
            question = f'What does {column}{where} command?{follows}'
            # The name of a rotor is any name, unless a vehicle file has them
            choices.decide(key, options, question, is_open=not rotors)
            open_.append(column)
    return open_
