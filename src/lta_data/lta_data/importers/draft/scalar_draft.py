# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Draft single columns: actuators, battery, range, pressure."""

from collections.abc import Mapping, Sequence
import re
from typing import Any, Final

from lta_config.errors import BadInput, unknown_name_error
from lta_data.even_grid import sort_samples
from lta_data.importers.draft.choices import BODY_AXES, DraftChoices
from lta_data.importers.draft.column_groups import LENGTH_SCALES
from lta_data.importers.draft.generic_commands import draft_axis_commands, find_axis_commands
from lta_data.importers.draft.vector_drafts import FLIGHT_SPEEDS
from lta_data.importers.protocol import Numbers
from lta_data.interpretation.column_group import Columns
from lta_data.interpretation.column_names import (
    ACTUATOR_PART_WORDS,
    ACTUATOR_WORDS,
    BODY_WORDS,
    ColumnName,
    is_placed_command,
    NUMBERED,
    PLACE_WORDS,
    SERVOS,
    UNIT_WORDS,
    WORD_PATTERN,
)
import numpy as np

# Of a height that can be in m; above it, a laboratory counts mm [m]
HIGHEST_FLIGHT: Final = 3000.0
CLIMB_TIME: Final = 1.0  # over which noise of a sensor does not count as a climb [s]
# Words -> topic, part, candidate units with the values that a flight log has in each
SCALARS: Final = (
    ('vbat voltage volt volts vbatt batt battery', 'battery', 'voltage',
     {'V': (2.5, 61.0), 'mV': (2500.0, 61000.0)}),
    ('current curr amps', 'battery', 'current', {'A': (0.0, 60.0), 'mA': (60.0, 60000.0)}),
    ('range tof lidar sonar zrange', 'range', 'range',
     {'m': (0.01, 30.0), 'mm': (30.0, 30000.0), 'cm': (30.0, 400.0)}),
    ('height altitude', 'range', 'range',
     {'m': (0.01, HIGHEST_FLIGHT), 'mm': (30.0, 30000.0), 'cm': (30.0, 400.0)}),
    ('pressure baro press', 'pressure', 'pressure',
     {'Pa': (3e4, 1.1e5), 'hPa': (300.0, 1100.0)}),
)  # fmt: skip
# Of an altitude that is no distance from the floor
SEA_LEVEL_WORDS: Final = frozenset(['sea', 'sealevel', 'msl', 'amsl', 'asl', 'gps', 'geoid'])
CORNER_WORDS: Final = frozenset(['rl', 'rr', 'bl', 'br'])  # of a quadrotor, beside fl and fr
FORCES: Final = frozenset(['f', 'force', 'fl', 'fr', 'fu', 'thrust', 'forces']) | CORNER_WORDS
UPSTREAM: Final = frozenset(
    ['pid', 'controller', 'controls', 'cmd', 'setpoint', 'sp', 'ref', 'mixer', 'stabilizer']
)
GRAM_UNITS: Final = frozenset(['g', 'gf', 'grams'])  # of thrust
LARGEST_DUTY: Final = 1.05
LARGEST_THRUST: Final = 60.0  # below it, numbers of a thrust can be %, N or grams
SIDE_WORDS: Final = {'l': 'left', 'r': 'right'}
RESTING_PULSE: Final = 15.0  # a motor stands at a pulse nearer to its rest [us]
STANDING_SHARE: Final = 0.05  # share of the pulses at which motors stand, in a log with pauses
# Share of the pulses on each side of 1500 us of a motor that may reverse
REVERSED_SHARE: Final = 0.1
ACTUATOR_NAME: Final = re.compile(r'[a-z][a-z0-9_]*')
ROTOR_SPEED_WORDS: Final = frozenset(['rpm', 'speed', 'rotorspeed', 'omega'])
# What has a speed: a rotor, or the vehicle through air or over ground
ROTATING_WORDS: Final = frozenset([
    'thruster', 'thrusters', 'fan', 'fans', 'propellers', 'props', 'engine', 'engines',
    # Where a rotor is
    'port', 'starboard', 'bow', 'stern', 'fl', 'fr', 'rl', 'rr', 'bl', 'br',
])  # fmt: skip
REAR_WORDS: Final = frozenset(['rear', 'back', 'tail'])
TRAVEL_WORDS: Final = frozenset(['ground', 'gps', 'gnss', 'air', 'wind', 'vehicle', 'body'])


def draft_scalars(
    prefix: str,
    table: Columns,
    names: Sequence[ColumnName],
    seconds: Numbers,
    choices: DraftChoices,
) -> list[dict[str, Any]]:
    """Return the entries of the topics that single columns fill; `seconds` are of the rows."""
    topics: dict[str, dict[str, Any]] = {}
    taken: set[str] = set()
    for words, topic, part, units in SCALARS:
        for name in names:
            fits = name.words & frozenset(words.split()) and name.column not in taken
            fits = fits and not (topic == 'range' and name.words & SEA_LEVEL_WORDS)
            if fits and part not in topics.get(topic, {}):
                key = f'{topic}.{part}.unit'
                unit, why = _choose_unit(key, name, table[name.column], seconds, units, choices)
                if unit:
                    scale = UNIT_WORDS.get(name.unit, ('', 1.0))[1]
                    topics.setdefault(topic, {})[part] = {
                        'column': name.column, 'unit': unit,
                    } | ({} if scale == 1.0 else {'scale': scale})  # fmt: skip
                    taken.add(name.column)
                    choices.add_reason(f'{topic}: {part}', [name.column], unit, why)
    axes = find_axis_commands([name for name in names if name.column not in taken], choices)
    taken |= {name.column for name in axes.values()}
    rest = [name for name in names if name.column not in taken]
    decided = [one for one in rest if choices.find_answer(f'{one.column}.topic') == 'motors']
    motors = decided or [
        name
        for name in rest
        if _commands_rotor(name, rest, choices) and np.isfinite(table[name.column]).any()
    ]
    # What a controller asks of a mixer is no actuator, where the actuators are there
    motors = decided or [name for name in motors if not name.words & UPSTREAM] or motors
    entries: list[dict[str, Any]] = [{'topic': topic} | parts for topic, parts in topics.items()]
    told_axes = any(f'{name.column}.command' in choices.answers for name in axes.values())
    # A servo beside forces turns what makes them
    if axes and (told_axes or all(name.words & SERVOS for name in motors)):
        entries.append(draft_axis_commands(axes, table, choices))
    elif motors:
        entries.append({'topic': 'motors', 'actuators': _draft_actuators(motors, table, choices)})
    return [entry | ({'table': prefix} if prefix else {}) for entry in entries]


def _commands_rotor(name: ColumnName, names: Sequence[ColumnName], choices: DraftChoices) -> bool:
    """Return whether a column commands an actuator: as the user says, else by its name."""
    if answer := choices.find_answer(f'{name.column}.command'):
        return answer not in ('none', *BODY_AXES)
    if UNIT_WORDS.get(name.unit, ('',))[0] == 'm/s':
        return False
    speeds = ROTOR_SPEED_WORDS if _names_rotor(name, names) else {'rpm', 'rotorspeed'}
    return bool(name.words & (ACTUATOR_WORDS | FORCES | speeds) or is_placed_command(name.column))


def _names_rotor(name: ColumnName, names: Sequence[ColumnName]) -> bool:
    """Return whether a number, a place or a word makes a speed that of a rotor."""
    # A vehicle has a speed to its front, and one to its side; rotors are at both ends
    is_alone = not any(other.words & REAR_WORDS for other in names)
    if 'side' in name.words or ('front' in name.words and is_alone):
        return bool(name.words & (ROTATING_WORDS | ACTUATOR_PART_WORDS))
    numbered = any(word[-1].isdigit() for word in (*name.stem, name.axis) if word)
    # The vertical speed is that of the vehicle
    nouns = name.words & (ROTATING_WORDS | PLACE_WORDS - {*BODY_WORDS})
    return bool(numbered or nouns) and not name.words & TRAVEL_WORDS


def _choose_unit(
    key: str,
    name: ColumnName,
    values: Numbers,
    seconds: Numbers,
    units: Mapping[str, tuple[float, float]],
    choices: DraftChoices,
) -> tuple[str, str]:
    """Return the unit of a column and the reason; '' if its values fit none."""
    named_unit = UNIT_WORDS.get(name.unit, ('',))[0]
    if named_unit in units:
        return named_unit, 'the unit in the name'
    typical = float(np.nanmedian(np.abs(values)))
    fitting = [unit for unit, (low, high) in units.items() if low <= typical <= high]
    # The range finder of a Crazyflie counts millimetres
    if len(fitting) < 2 or 'zrange' in name.words:
        return (fitting or [''])[0], f'its median is {typical:.4g}'
    question = f"The median of '{name.column}' is {typical:.4g}, which fits each unit."
    if {*units} <= {*LENGTH_SCALES} and key not in choices.answers:
        climb = _measure_climb(values, seconds)
        slow = [one for one in fitting if climb * LENGTH_SCALES[one] <= FLIGHT_SPEEDS[1]]
        if len(slow) == 1:
            return slow[0], f'it changes by {climb:.3g} per second, too fast in another unit'
        fitting = slow or fitting
    return choices.decide(key, [(unit, '') for unit in fitting], question), choices.explain(key)


def _measure_climb(values: Numbers, seconds: Numbers) -> float:
    """Return how fast a height usually changes, in its unit per second; 0.0 if unknown."""
    time, height = sort_samples(seconds, values).select_complete()
    whole = time + CLIMB_TIME <= time[-1:]
    if not whole.any():
        return 0.0
    later = np.interp(time[whole] + CLIMB_TIME, time, height)
    return float(np.percentile(np.abs(later - height[whole]), 75.0)) / CLIMB_TIME


def _draft_actuators(
    motors: Sequence[ColumnName], table: Columns, choices: DraftChoices
) -> dict[str, Any]:
    """Return the actuators: servos, and what rotors do, in one of the ways that a log has it."""
    families: dict[tuple[str, frozenset[str]], list[ColumnName]] = {}
    for name in motors:
        families.setdefault((name.unit, name.words & ACTUATOR_WORDS), []).append(name)
    servos = [one for one in families.values() if one[0].words & SERVOS]
    turned = [one for one in families.values() if one not in servos]
    rotors = turned[:1]
    if len(turned) > 1 and len({len(one) for one in turned}) == 1:
        # Duties beside speeds or thrusts of the same rotors
        options = [(one[0].column, ', '.join(name.column for name in one)) for one in turned]
        question = (
            'Several columns for each rotor are there; one kind of them can be the commands.'
        )
        answer = choices.decide('motors.columns', options, question)
        rotors = [one for one in turned if one[0].column == answer]
    elif len(turned) > 1:
        rotors = [[name for one in turned for name in one]]
    drafted = [_draft_family(one, table, choices) for one in (*rotors, *servos)]
    return {name: part for family in drafted for name, part in family.items()}


def _draft_family(
    motors: Sequence[ColumnName], table: Columns, choices: DraftChoices
) -> dict[str, Any]:
    """Return actuators with one unit: duties, forces, rotor speeds or angles, by name and size."""
    values = np.concatenate([np.abs(table[name.column]) for name in motors])
    values = values[np.isfinite(values)]
    size = float(np.percentile(values, 99.0)) if len(values) else 0.0
    columns = [name.column for name in motors]
    words = frozenset().union(*(name.words for name in motors))
    units = {UNIT_WORDS.get(name.unit, ('',))[0] for name in motors} - {''}
    units |= {'gf'} if {name.unit for name in motors} & GRAM_UNITS else set()
    kind, field, why = _judge_actuators(words, units, size, values)
    key = 'motors.unit'
    if kind == 'pulse':
        kind, why = _judge_pulses(motors, table, key, choices)
    if kind == '?':
        share = 'duty' if size <= LARGEST_DUTY else '%'
        options = [(share, f'up to {size:.3g}'), ('N', f'a force of {size:.3g} N'),
                   ('gf', f'a force of {size:.3g} g')]  # fmt: skip
        kind = choices.decide(
            key, options, f'"thrust" up to {size:.3g} can be a share or a force.'
        )
        why = choices.explain(key)
    kind = choices.override(key, kind)
    field = {'rpm': 'velocity', 'rad/s': 'velocity', 'deg': 'position', 'rad': 'position'}.get(
        kind, field
    )
    choices.add_reason('motors', columns, kind, why)
    scales: dict[str, dict[str, Any]] = {
        'duty': {}, 'N': {'unit': 'N'}, 'mN': {'unit': 'mN'}, '%': {'unit': '%'},
        'gf': {'unit': 'N', 'scale': UNIT_WORDS['gf'][1]},
        'deg': {'unit': 'deg'}, 'rad': {'unit': 'rad'},
        'pulse': {'offset': -1000, 'over': 1000},
        'pulse about 1500': {'offset': -1500, 'over': 500}, 'of 255': {'over': 255},
        'of 65535': {'over': 65535}, 'rpm': {'unit': 'rpm'}, 'rad/s': {'unit': 'rad/s'},
    }  # fmt: skip
    extra = scales.get(kind, {})
    called = _name_actuators(motors, choices)
    return {
        called[index]: {field: {'column': name.column} | extra}
        for index, name in enumerate(motors)
    }


def _judge_pulses(
    motors: Sequence[ColumnName], table: Columns, key: str, choices: DraftChoices
) -> tuple[str, str]:
    """Return whether motors that get pulses stand at 1000 or at 1500 us, and the reason."""
    values = np.concatenate([table[name.column] for name in motors])
    values = values[np.isfinite(values) & (values > 0.0)]
    stop, middle = (_measure_rest(values, rest) for rest in (1000.0, 1500.0))
    both = min(np.mean(values < 1500.0 - RESTING_PULSE), np.mean(values > 1500.0 + RESTING_PULSE))
    # A step in one direction has pulses on one side of 1500 us alone
    if middle > STANDING_SHARE >= stop:
        return 'pulse about 1500', 'pulses about 1500 us, at which the motors often stand'
    if both < REVERSED_SHARE or stop > STANDING_SHARE:
        return 'pulse', 'pulses of 1000 to 2000 us'
    options = [
        ('pulse', 'motors stand at 1000 us and turn one way'),
        ('pulse about 1500', 'motors stand at 1500 us and turn both ways'),
    ]
    question = 'Pulses below and above 1500 us can be slow and fast, or back and forth.'
    return choices.decide(key, options, question), choices.explain(key)


def _measure_rest(values: Numbers, rest: float) -> float:
    """Return the share of pulses at which motors stand; 0 where they only pass by."""
    near = values[np.abs(values - rest) < RESTING_PULSE]
    # A motor that stands repeats one pulse, one that hovers there has all around it
    most = float(np.unique(near, return_counts=True)[1].max()) if len(near) else 0.0
    return most / len(values) if most > 0.5 * len(near) else 0.0


def _judge_actuators(
    words: frozenset[str], units: set[str], size: float, values: Numbers
) -> tuple[str, str, str]:
    """Return the unit of actuators, their message field, and the reason; '?' if two fit."""
    for unit in ('rpm', 'rad/s'):
        if unit in units or (unit == 'rpm' and 'rpm' in words):
            return unit, 'velocity', 'rotor speeds; add "thrust: [c0, c1, c2]" for a thrust law'
    for unit in ('gf', 'N', 'mN', '%', 'deg', 'rad'):
        if unit in units:
            return unit, 'effort', 'the unit in the names'
    if words & ROTOR_SPEED_WORDS:
        return 'rad/s', 'velocity', 'the word speed'
    named_force = bool(words & (FORCES - {'thrust'})) and not words & {'pwm', 'duty', 'throttle'}
    is_thrust = 'thrust' in words and not words & {'pwm', 'duty', 'motor', 'm'}
    if is_thrust and size <= LARGEST_THRUST:
        return '?', 'effort', ''
    if size <= LARGEST_DUTY:
        if named_force:
            return 'N', 'effort', f'a word for force; up to {size:.3g}'
        return 'duty', 'effort', f'99 % are below {size:.3g}'
    busy = values[values > 0.0]
    if 800.0 <= float(np.median(busy)) <= 2200.0 and float(busy.max()) <= 2500.0:
        return 'pulse', 'effort', 'pulses of 1000 to 2000 us'
    if named_force and size < 50.0:
        return 'N', 'effort', f'a word for force; up to {size:.3g}'
    for kind, limit in (('%', 100.5), ('of 255', 255.5), ('of 65535', 65535.5)):
        if size <= limit:
            return kind, 'effort', f'99 % are below {size:.4g}'
    return 'duty', 'effort', f'99 % are below {size:.4g}, which is no usual scale'


def _name_actuators(motors: Sequence[ColumnName], choices: DraftChoices) -> list[str]:
    """Return the names of actuators: as the user or the vehicle file calls them, else by place."""
    places = _list_places(motors)
    # As rotors are called in vehicle files
    called = places if all(places) and len({*places}) == len(places) else [
        _name_actuator(name, index) for index, name in enumerate(motors)
    ]  # fmt: skip
    for index, name in enumerate(motors):
        key = f'{name.column}.command'
        answer = choices.find_answer(key)
        if answer and not ACTUATOR_NAME.fullmatch(answer):
            raise BadInput(
                f"--set {key}: '{answer}' is no name of an actuator; use small letters, digits "
                'and _.'
            )
        rotors = () if choices.vehicle is None else choices.vehicle.rotors
        if places[index] in rotors:
            called[index] = places[index]
        if answer and rotors and answer not in rotors:
            raise unknown_name_error(f'rotor for {key}', answer, [*rotors])
        if answer:
            called[index] = answer
        # The numbers of an array were asked for
        elif rotors and called[index] not in rotors and not NUMBERED.fullmatch(name.column):
            options = [*((rotor, 'a rotor') for rotor in rotors), ('none', 'none of them')]
            question = f'Which rotor of the vehicle file does {name.column} command?'
            called[index] = choices.decide(key, options, question)
    return called


def _list_places(motors: Sequence[ColumnName]) -> list[str]:
    """Return where each actuator is by the words of its column: 'left' of pwm_left or Fl."""
    split = [[word.lower() for word in WORD_PATTERN.findall(name.column)] for name in motors]
    there = {word for words in split for word in words}
    if there >= {'fl', 'fr'} and not there & CORNER_WORDS:
        # The forces left and right, of no quadrotor
        split = [[{'fl': 'left', 'fr': 'right'}.get(word, word) for word in words]
                 for words in split]  # fmt: skip
    return [
        '_'.join(SIDE_WORDS.get(word, word) for word in words if word in PLACE_WORDS)
        for words in split
    ]


def _name_actuator(name: ColumnName, index: int) -> str:
    """Return a name for an actuator, of the words of its column; an index alone says nothing."""
    words = re.sub(r'[^a-z0-9]+', '_', name.column.lower()).strip('_')
    nameless = not words[:1].isalpha() or NUMBERED.fullmatch(name.column)
    return f'motor_{index + 1}' if nameless else words
