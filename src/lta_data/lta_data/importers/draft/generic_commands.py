"""
List commands whose names do not say what they drive: `u1`, `tau_2`, `joy_x`, `thrust`.

Three numbers such as `tau1, tau2, tau3` can be a moment, the force ahead with the force up and the
moment about z, or three rotors. The motion decides (`command_motion.py`), else the user.
"""

from collections.abc import Iterator, Sequence
from typing import Final

from lta_data.importers.draft.axis_commands import find_lettered_axes, find_named_axes
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.column_groups import needs_translation
from lta_data.importers.draft.name_hints import (
    ACTIONS,
    ANGLES,
    BODY_WORDS,
    ColumnName,
    COMMANDS,
    JOYSTICKS,
    KINDS,
    PARTS,
    PLACES,
    SERVOS,
)

VECTORS: Final = KINDS['force'] | KINDS['torque'] | {'t'}
# Words of a command that name neither its axis nor the actuator
GENERIC: Final = COMMANDS | JOYSTICKS | VECTORS | {'u', 'ch', 'channel', 'chan', *ACTIONS}
# Of a remote control: what a servo or a rudder turns, only the builder knows
SURFACES: Final = frozenset(['rudder', 'elevator', 'aileron', 'steer', 'steering', *SERVOS])
THRUSTS: Final = frozenset(['thrust', 'throttle', 'thr'])
MEANINGS: Final = {
    'surge': 'the force forward', 'sway': 'the force to the left', 'heave': 'the force up',
    'roll': 'the moment about x', 'pitch': 'the moment about y', 'yaw': 'the moment about z',
}  # fmt: skip
ORDERS: Final = frozenset(['cmd', 'command', 'commanded'])  # cmd_z may be a height


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
        if name.axis.isdigit() and name.stem and {*name.stem} <= GENERIC:
            families.setdefault(name.stem, []).append(name)
    vectors = [stem for stem, family in families.items() if {*stem} & VECTORS and len(family) == 3]
    for stem, family in families.items():
        is_pair = stem in vectors and len(vectors) > 1
        is_six = {*stem} & KINDS['torque'] and len(family) == 6
        is_place = 't' in stem and needs_translation(names)
        if len(family) > 1 and not (is_pair or is_six or is_place):
            yield from family


def _list_thrusts(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield the one thrust beside commands of body axes, with angles that may be setpoints."""
    thrusts = [name for name in names if name.words & THRUSTS and not name.axis
               and not name.words & (PARTS | PLACES | {*BODY_WORDS})]  # fmt: skip
    axes = find_named_axes(names, has_linear=True)
    if len(thrusts) == 1 and axes:
        yield from thrusts
        yield from (name for name in axes.values() if {*name.stem} <= COMMANDS and name.stem)


def _list_surfaces(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield the one throttle beside a rudder, servo or steering, and these."""
    thrusts = [name for name in names if name.words & THRUSTS and not name.words & PLACES]
    surfaces = [
        name for name in names if name.words & SURFACES and name.words <= GENERIC | SURFACES
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
        partial = {*stem} <= ORDERS and len(axes & {*'xyz'}) in (1, 2)
        if stem and (partial or (stem == ('u',) and axes == {*'xyz'})):
            yield from (each for each in family if each.axis in {*'xyz', *ANGLES.values()})


def _list_letters(names: Sequence[ColumnName]) -> Iterator[ColumnName]:
    """Yield commands whose letters name no axis, such as u_v and u_h."""
    named = find_named_axes(names).values()
    lettered = [
        name for name in names
        if len(name.stem) == 2 and not name.axis and name not in named
        and name.stem[0] in {*COMMANDS, 'u'} and len(name.stem[1]) == 1
        and name.stem[1] not in PLACES
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
