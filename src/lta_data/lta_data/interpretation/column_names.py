# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read the names of columns: stem, axis and unit, and what the words of a stem stand for."""

from collections.abc import Iterable, Sequence
import re
from typing import Final, final, NamedTuple

# Unit as written in a name -> unit of a mapping, and a further factor
UNIT_WORDS: Final[dict[str, tuple[str, float]]] = {
    'm': ('m', 1.0), 'mm': ('mm', 1.0), 'cm': ('cm', 1.0), 'meters': ('m', 1.0),
    'ft': ('m', 0.3048), 'feet': ('m', 0.3048), 'ft/s': ('m/s', 0.3048),
    's': ('s', 1.0), 'sec': ('s', 1.0), 'ms': ('ms', 1.0), 'us': ('us', 1.0), 'ns': ('ns', 1.0),
    'min': ('min', 1.0),
    'rad': ('rad', 1.0), 'deg': ('deg', 1.0), 'degrees': ('deg', 1.0), '°': ('deg', 1.0),
    'm/s': ('m/s', 1.0), 'mps': ('m/s', 1.0), 'm s^-1': ('m/s', 1.0), 'mm/s': ('m/s', 0.001),
    'cm/s': ('m/s', 0.01), 'km/h': ('m/s', 1.0 / 3.6), 'mph': ('m/s', 0.44704),
    'knots': ('m/s', 1.852 / 3.6),
    'rad/s': ('rad/s', 1.0), 'rad s^-1': ('rad/s', 1.0),
    'radps': ('rad/s', 1.0), 'deg/s': ('deg/s', 1.0), 'dps': ('deg/s', 1.0),
    'degps': ('deg/s', 1.0), '°/s': ('deg/s', 1.0), 'rpm': ('rpm', 1.0),
    'm/s2': ('m/s2', 1.0), 'm/s^2': ('m/s2', 1.0), 'm s^-2': ('m/s2', 1.0),
    'mss': ('m/s2', 1.0), 'g': ('m/s2', 9.80665), 'gs': ('m/s2', 9.80665),
    'n': ('N', 1.0), 'mn': ('mN', 1.0), 'nm': ('N m', 1.0),
    'n m': ('N m', 1.0), 'mnm': ('mN m', 1.0), 'mn m': ('mN m', 1.0),
    'v': ('V', 1.0), 'mv': ('mV', 1.0),
    'volts': ('V', 1.0), 'a': ('A', 1.0), 'ma': ('mA', 1.0), 'pa': ('Pa', 1.0),
    'hpa': ('hPa', 1.0), 'mbar': ('hPa', 1.0), '%': ('%', 1.0), 'percent': ('%', 1.0),
    # Words of a name that stand apart: vx_m_s
    'm s': ('m/s', 1.0), 'm s2': ('m/s2', 1.0), 'rad s': ('rad/s', 1.0),
    'deg s': ('deg/s', 1.0), 'newton': ('N', 1.0), 'newtons': ('N', 1.0),
    'newton meter': ('N m', 1.0), 'newton meters': ('N m', 1.0),
    'gf': ('N', 0.00980665), 'grams': ('N', 0.00980665),
}  # fmt: skip
FORCE_UNITS: Final = ('N', 'mN', 'N m', 'mN m')
# Words at the end of a name that are units, not axes or quantities
ENDINGS: Final = frozenset([
    'mm', 'cm', 'ft', 'feet', 'ms', 'us', 'ns', 'sec', 'rad', 'deg', 'degrees', 'mps', 'radps',
    'dps', 'degps', 'rpm', 'mss', 'mv', 'volts', 'ma', 'pa', 'hpa', 'mbar', 'percent',
])  # fmt: skip
AXIS_WORDS: Final = frozenset(['x', 'y', 'z', 'w', 'n', 'e', 'd', 'i', 'j', 'k'])
ANGLE_WORDS: Final = {
    'roll': 'roll', 'pitch': 'pitch', 'yaw': 'yaw', 'heading': 'yaw',
    'phi': 'roll', 'theta': 'pitch', 'psi': 'yaw', 'th': 'pitch',
    'hdg': 'yaw', 'compass': 'yaw', 'azimuth': 'yaw',
    'rollwinkel': 'roll', 'nickwinkel': 'pitch', 'gierwinkel': 'yaw',
    'roulis': 'roll', 'tangage': 'pitch', 'lacet': 'yaw',
}  # fmt: skip
ANGLE_AXES: Final = {'roll': 'x', 'pitch': 'y', 'yaw': 'z'}
COMPASS: Final = {'north': 'n', 'east': 'e', 'down': 'd'}
HEADINGS: Final = frozenset(['heading', 'hdg', 'compass', 'azimuth'])  # clockwise from north
LATITUDES: Final = frozenset(['lat', 'latitude'])
LONGITUDES: Final = frozenset(['lon', 'lng', 'long', 'longitude'])
HEIGHT_WORDS: Final = frozenset(['alt', 'altitude', 'height', 'elevation'])
# An element of an array, whose name says nothing
NUMBERED: Final = re.compile(r'(data|axes|buttons|channels|values)\[\d+\]')
JOINED: Final = re.compile(
    r'(pos|vel|acc|accel|gyr|gyro|omega|euler|quat|force|torque|tau|moment|angvel|rate|speed'
    r'|[pvqwtagfrobe]'
    r'|m(?=[xyz])|u(?=[xyz\d])|(?:cmd|ctrl|control|input|chan|channel|ch)(?=\d))([xyzwned]|\d)'
)
# An angle behind the letter of a command: upsi
TURNED_WORD: Final = re.compile(r'(tau|cmd|[uftm])(roll|pitch|yaw|phi|theta|psi)')
# A rate behind its angle: rollrate, yawspeed
SPUN_WORD: Final = re.compile(r'(roll|pitch|yaw|phi|theta|psi)(rate|speed|vel|dot)')
# A velocity behind its axis: xdot
MOVED_WORD: Final = re.compile(r'([xyz])(vel|speed|dot)')
# The frame of a quantity, which is not what it is: XToGlobal1
FRAME_WORD: Final = re.compile(r'to|wrt|global\d?')
WORD_PATTERN: Final = re.compile(r'[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+\d?|[A-Z]+\d?|\d+')

KIND_WORDS: Final[dict[str, frozenset[str]]] = {
    name: frozenset(words.split())
    for name, words in {
        'quaternion': 'q quat quaternion orientation rotation attitude att',
        'euler': 'e euler rpy angles angle ang attitude att orientation rotvec rvec helical',
        'rates': 'w wb omega gyro gyr gyros gyroscope rates rate angular avl angvel pqr o turn',
        'acceleration': 'a acc accel acceleration accelerometer accelerations specific',
        'velocity': 'v vel velocity vb speed linear twist dot',
        'torque': 'tau torque moment moments',
        'force': 'f force forces',
        'position': 'p pos position positions xyz loc location translation trans t pose place '
        'tracker',
    }.items()
}
# Words for angles, and for their first and second derivative
TURN_WORDS: Final = frozenset([
    'ang', 'angle', 'angles', 'angular', 'rot', 'rotational', 'euler', 'rpy', 'attitude', 'att',
])  # fmt: skip
FIRST_DERIVATIVES: Final = frozenset(
    ['vel', 'velocity', 'velocities', 'speed', 'rate', 'rates', 'dot']
)
SECOND_DERIVATIVES: Final = frozenset(['acc', 'accel', 'acceleration', 'accelerations', 'ddot'])
ROLE_WORDS: Final[dict[str, frozenset[str]]] = {
    name: frozenset(words.split())
    for name, words in {
        'setpoint': 'sp set setpoint ref reference des desired cmd command commanded target goal '
        'ctrltarget controller',
        'estimate': 'est estimate estimated ekf kf kalman estimator odom vio vo filter hat fused '
        'onboard stabilizer',
        'truth': 'vicon mocap opti optitrack motive gt truth ground true tracker qualisys vrpn '
        'rigid marker markers groundtruth',
    }.items()
}
TIME_WORDS: Final = frozenset(
    [
        't',
        'time',
        'timestamp',
        'timestamps',
        'stamp',
        'sec',
        'secs',
        'seconds',
        'clock',
        'tick',
        'elapsed',
        'epoch',
    ]
)
ACTUATOR_WORDS: Final = frozenset([
    'motor', 'motors', 'm', 'pwm', 'thrust', 'throttle', 'duty', 'rpm', 'rotor', 'rotors', 'esc',
    'prop', 'propeller', 'u', 'servo', 'act', 'actuator', 'actuators', 'thr', 'rc', 'rcou',
    'output', 'outputs',
])  # fmt: skip


# Words for one actuator, which is no command of a body axis
ACTUATOR_PART_WORDS: Final = frozenset([
    'motor', 'motors', 'pwm', 'duty', 'rpm', 'rotor', 'rotors', 'esc', 'prop', 'propeller',
    'servo', 'm',
])  # fmt: skip
# Words for the body axes of a command; those of PLACES can also be the place of a rotor
BODY_WORDS: Final = {
    'surge': 'surge', 'forward': 'surge', 'fwd': 'surge', 'longitudinal': 'surge',
    'sway': 'sway', 'lateral': 'sway', 'heave': 'heave', 'vertical': 'heave', 'up': 'heave',
    'roll': 'roll', 'pitch': 'pitch', 'yaw': 'yaw',
    'lift': 'heave', 'turn': 'yaw', 'steer': 'yaw', 'steering': 'yaw',
}  # fmt: skip
# Not without a word for a command: a lift is measured, too
LOOSE_WORDS: Final = frozenset(['lift', 'turn', 'steer', 'steering'])
# The letters of marine craft: forces X, Y, Z with moments K, M, N, or along velocities u to r
AXIS_LETTERS: Final = ('xyzkmn', 'uvwpqr')
JOYSTICKS: Final = frozenset(['joy', 'joystick', 'gamepad', 'stick', 'sticks'])
# Integers of a Crazyflie's stateEstimateZ
COMPRESSED: Final = ('state', 'estimate', 'z')
COMPRESSED_UNITS: Final = {'z': 'mm', 'v': 'mm/s'}
SERVOS: Final = frozenset(['servo', 'servos'])
# Of what is no quantity of the vehicle, but how well it is known
UNCERTAINTY_WORDS: Final = frozenset([
    'covariance', 'covariances', 'cov', 'variance', 'variances', 'var', 'std', 'stdev', 'stddev',
    'sigma', 'sigmas', 'uncertainty', 'uncertainties', 'bias', 'biases', 'error', 'errors', 'err',
    'residual', 'residuals', 'innovation', 'innovations',
])  # fmt: skip
# Of what is known better: gyro_no_bias_x
CORRECTED_WORDS: Final = frozenset(['no', 'without', 'corrected', 'compensated'])
# What a learned controller puts out; a1, a2, a3 can be an acceleration, too
ACTIONS: Final = frozenset(['a', 'act', 'action', 'actions'])
# A command of a place is that of the actuator there: cmd_left
COMMAND_WORDS: Final = frozenset(['cmd', 'command', 'commanded', 'ctrl', 'control', 'input'])
PLACE_WORDS: Final[frozenset[str]] = frozenset([
    'left', 'right', 'up', 'down', 'front', 'rear', 'back', 'top', 'bottom', 'main', 'tail',
    'side', 'vertical', 'lateral', 'l', 'r',
])  # fmt: skip


@final
class ColumnName(NamedTuple):
    """A name of a column, taken apart."""

    column: str  # as in the log
    stem: tuple[str, ...]  # its words in lower case, without axis and unit
    axis: str  # x, y, z, w, n, e, d, roll, pitch, yaw, an index, or ''
    unit: str  # as written, if it is known; else ''

    @property
    def words(self) -> frozenset[str]:
        """Return the words of the stem, also without an index at their end."""
        return frozenset({*self.stem, *(word.rstrip('0123456789') for word in self.stem)})


def parse_column_name(column: str) -> ColumnName:
    """Take the name of a column apart."""
    name = _split_name(column)
    compressed = name.stem[:3] == COMPRESSED and not name.unit
    return name._replace(unit=COMPRESSED_UNITS.get(name.stem[-1], '')) if compressed else name


def _split_name(column: str) -> ColumnName:
    text, unit = column, ''
    # x [m], x (m), "x, m" or x / m
    for ending in (r'\s*[\[(]([^\[\]()]*)[\])]\s*$', r'\s*(?:,|\s/)\s*([^\s,/][^,]*)$'):
        match = re.search(ending, column)
        if match and match.start() and (token := _normalise_unit(match[1])) in UNIT_WORDS:
            text, unit = column[: match.start()], token
            break
    tokens = [token for token in re.split(r'[_\s.]+', text) if token]
    for count in (2, 1):
        end = ' '.join(tokens[-count:]).lower()
        rest = [word.lower() for token in tokens[:-count] for word in WORD_PATTERN.findall(token)]
        # A row of units may repeat what the names say: fx_N [N]
        is_same = not unit or UNIT_WORDS.get(end) == UNIT_WORDS[unit]
        if is_same and rest and end in UNIT_WORDS and _ends_with_unit(rest, end):
            return _find_axis(column, rest, end)
    return _find_axis(column, [word.lower() for word in WORD_PATTERN.findall(text)], unit)


def _normalise_unit(text: str) -> str:
    """Return a unit as UNIT_WORDS has it: N m of N.m, N*m and N·m."""
    return re.sub(r'[\s.*·]+', ' ', text.strip().lower().replace('²', '2'))


def _find_axis(column: str, words: Sequence[str], unit: str) -> ColumnName:
    """Return a name of words in lower case."""
    words = [word for word in words if not FRAME_WORD.fullmatch(word)] or words
    for index in range(len(words) - 1, -1, -1):
        word = words[index]
        if (angle := ANGLE_WORDS.get(word)) is not None:
            # A compass heading is one angle
            rest = [one for one in words if ANGLE_WORDS.get(one) != angle]
            return ColumnName(column, (*rest,), angle, unit)
        if word in COMPASS:
            return ColumnName(column, (*words[:index], *words[index + 1 :]), COMPASS[word], unit)
        if word in AXIS_WORDS or word.isdigit():
            return ColumnName(column, (*words[:index], *words[index + 1 :]), word, unit)
        if numbered := re.fullmatch(r'([xyz])(\d)', word):
            stem = (*words[:index], numbered[2], *words[index + 1 :])
            return ColumnName(column, stem, numbered[1], unit)
        if joined := JOINED.fullmatch(word) or TURNED_WORD.fullmatch(word):
            stem = (*words[:index], joined[1], *words[index + 1 :])
            return ColumnName(column, stem, ANGLE_WORDS.get(joined[2], joined[2]), unit)
        if moved := MOVED_WORD.fullmatch(word):
            return ColumnName(column, (*words[:index], 'vel', *words[index + 1 :]), moved[1], unit)
        if spun := SPUN_WORD.fullmatch(word):
            stem = (*words[:index], 'rate', *words[index + 1 :])
            return ColumnName(column, stem, ANGLE_WORDS[spun[1]], unit)
    return ColumnName(column, tuple(words), '', unit)


def _ends_with_unit(words: Sequence[str], end: str) -> bool:
    """Return whether the end of a name is the unit of what the words before it name."""
    if end in ENDINGS:
        return True
    if end in ('m', 's', 'min'):  # x_m, tx_m, t_s
        joined = JOINED.fullmatch(words[-1]) if end == 'm' else None
        is_place = joined is not None and joined[1] in KIND_WORDS['position']
        return is_place or words[-1] in ({*AXIS_WORDS, *COMPASS} if end == 'm' else TIME_WORDS)
    unit = UNIT_WORDS[end][0]
    name = _find_axis('', words, '')
    if unit in FORCE_UNITS:
        # A letter alone is that of a velocity too: u_n
        letters = (
            frozenset('tmu') if name.axis or any(word[-1].isdigit() for word in words) else {}
        )
        driven = ACTUATOR_WORDS - frozenset('mu') | {*BODY_WORDS, 'wrench', *letters}
        there = name.words | {name.axis}
        return match_kind(there) in ('force', 'torque') or bool(there & driven)
    if unit == 'm/s2':  # thrust_g is in grams
        return match_kind(name.stem) == 'acceleration' or 'thrust' in name.words
    # u_m_s, p_rad_s
    return unit in ('m/s', 'rad/s', 'deg/s') and (bool(name.axis) or words[-1] in {*'uvwpqr'})


def is_placed_command(column: str) -> bool:
    """Return whether a name consists of words for a command, and a place or a number."""
    words = frozenset(word.lower() for word in WORD_PATTERN.findall(column))
    rest = {word.rstrip('0123456789') for word in words} - COMMAND_WORDS - PLACE_WORDS - {''}
    numbered = any(word[-1].isdigit() for word in words)
    return bool((words & PLACE_WORDS or numbered) and not rest)


def match_kind(words: Iterable[str]) -> str:
    """Return the quantity that words name, '' if none."""
    there = frozenset(words)
    # An angle with a word for its derivative: ang_vel, roll_acc
    if there & TURN_WORDS:
        if there & SECOND_DERIVATIVES:
            return ''
        if there & FIRST_DERIVATIVES:
            return 'rates'
    # The quantity is named by a full word before it is by a letter
    for long in (True, False):
        for kind, kind_words in KIND_WORDS.items():
            if any((len(word) > 1) == long for word in there & kind_words):
                return kind
    return ''


def match_role(words: Iterable[str]) -> str:
    """Return the role that words name: 'setpoint', 'estimate', 'truth', or ''."""
    there = frozenset(words)
    if 'state' in there and 'estimate' in there:
        return 'estimate'
    return next((role for role, role_words in ROLE_WORDS.items() if there & role_words), '')


def tells_uncertainty(words: frozenset[str]) -> bool:
    """Return whether words name how well a quantity is known, and not the quantity itself."""
    return bool(words & UNCERTAINTY_WORDS) and not words & CORRECTED_WORDS


def needs_translation(names: Sequence[ColumnName]) -> bool:
    """Return whether tx, ty, tz are the only place beside an attitude, as in TUM's files."""
    places = [
        name for name in names
        if name.axis in ('x', 'n')
        and (match_kind(name.words) == 'position' or not name.stem)
        and 't' not in name.words
    ]  # fmt: skip
    turned = any(match_kind(name.words) == 'quaternion' or name.axis in ANGLE_AXES
                 for name in names if not name.words & KIND_WORDS['torque'])  # fmt: skip
    return turned and not places
