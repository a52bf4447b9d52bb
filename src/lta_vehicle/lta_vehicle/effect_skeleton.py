"""
Write the skeleton of an effect of one's own: a Python file, and the package that installs it.

From a law, the effect computes what the law does, with a parameter for each coefficient, so that
it can be changed step by step into the equations of the cause. A coefficient whose unit files do
not know is in N or N m, for factors of 1 in SI units.
"""

from collections.abc import Iterator, Sequence
from importlib.util import find_spec
import keyword
from pathlib import Path
from string import Template
from typing import Final

from lta_config.errors import BadInput
from lta_config.quantity import UNITS
from lta_config.schema.vehicle_file import load_vehicle_file, VehicleFile
from lta_config.schema.vehicle_law import (
    AXES,
    HIDDEN,
    HIDDEN_RATE,
    Law,
    LawFactor,
    LawTerm,
    LEAST_LAG,
    PERIOD,
)
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recorded_flight import open_flight
from lta_data.scene import read_scene
from lta_model.effects import MODEL_EFFECTS
from lta_model.effects.law import LARGEST_EXPONENT
from lta_model.law_text import describe_law

SPREAD: Final = 0.2  # relative, of a coefficient without an interval
REACH: Final = 100.0  # bounds of a coefficient, in its own size
# Quantities of a law in the functions of an effect; `turn` is motion.rotation
EXPRESSIONS: Final = {
    **{name: f'motion.airspeed[{k}]' for k, name in enumerate('uvw')},
    'speed': 'modulus(motion.airspeed)',
    **{name: f'motion.rates[{k}]' for k, name in enumerate('pqr')},
    'rate': 'modulus(motion.rates)',
    **{name: f'motion.position[{k}]' for k, name in enumerate(('x', 'y', 'height'))},
    'roll': 'math.atan2(turn[7], turn[8])',
    'pitch': 'math.atan2(-turn[6], math.sqrt(turn[7] * turn[7] + turn[8] * turn[8]))',
    'yaw': 'math.atan2(turn[3], turn[0])',
    'voltage': 'motion.surroundings[VOLTAGE]',
    'time': 'memory[2]',
    HIDDEN: 'memory[0]',
    HIDDEN_RATE: 'memory[1]',
    **{f'thrust_{k + 1}': f'thrust[{k}]' for k in range(8)},
    **{
        f'thrust_{axis}': f'sum_rotor_forces(motion.body[ROTOR_PLACE:], thrust)[{k}]'
        for k, axis in enumerate(list(AXES)[:6])
    },
}
PLACED: Final = ('x', 'y', 'height', 'roll', 'pitch', 'yaw', 'map_x', 'map_y', 'map_z')
EXAMPLE: Final = Law(
    source='where bounds and equation come from',
    terms=[
        LawTerm(axis='surge', coefficient=-0.01, unit='N s/m', factors=[LawFactor(quantity='u')])
    ],
    region={'u': [-1e3, 1e3]},
)
FILE: Final = Template('''"""An effect of one's own: $name."""

import math

# Remove what you do not need
from lta_model.effects.protocol import (
    EffectParameter,
    Values,
    Vector,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.rotor_forces import sum_rotor_forces
from lta_model.state import ROTOR_PLACE, VOLTAGE

PARAMETERS = (
    # Name, unit, null value, lowest, highest, typical deviation, source
$parameters
)


def modulus(vector: Vector) -> float:
    """Return the length of a vector."""
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


def fade(x: float, low: float, high: float) -> float:
    """Return 1 within a range, and less outside: 0 from half of its width on."""
    half = 0.5 * (high - low)
    s = min(max(abs(x - 0.5 * (high + low)) / half - 1.0, 0.0), 1.0)
    return 1.0 - s * s * (3.0 - 2.0 * s)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    $title.

$about
    """
    $unpack = p
    turn = motion.rotation
$quantities
$sums
    # From the axes of the map to those of the body
    return (
        surge + turn[0] * map_x + turn[3] * map_y + turn[6] * map_z,
        sway + turn[1] * map_x + turn[4] * map_y + turn[7] * map_z,
        heave + turn[2] * map_x + turn[5] * map_y + turn[8] * map_z,
        roll_moment,
        pitch_moment,
        yaw_moment,
    )
$rate

EFFECT = WrenchEffect(
    '$name',
    PARAMETERS,
    compute_wrench,
    linear_in=$linear,$memory
    placed=$placed,
)
''')
RATE: Final = Template('''

def compute_memory_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return d/dt of the hidden state, of its rate, and of the time since the start."""
    $unpack = p
    if $absent:
        return (0.0, 0.0, 0.0)
    turn = motion.rotation
$quantities
$drive
''')
PROJECT: Final = Template("""[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"

[project]
name = "$name"
version = "0.1.0"

[tool.setuptools]
py-modules = ["$name"]

[project.entry-points."lta.effects"]
$name = "$name:EFFECT"
""")


def load_law(source: str) -> Law:
    """
    Return the law of a vehicle file, by name or path, or of the vehicle file of a run.

    Raise `BadInput` if there is no such file or run, or it has no law.
    """
    file = _load_source(source)
    if file.law is None:
        raise BadInput(
            f'The vehicle file of {source} has no law; give one that has a block law, or leave '
            'out --from for an empty skeleton.'
        )
    return file.law


def _load_source(source: str) -> VehicleFile:
    """Return the vehicle file of a run, or by name or path."""
    folder = Path(source)
    if not folder.is_dir():
        return load_vehicle_file(source)
    if (folder / 'vehicle.yaml').is_file():
        return load_vehicle_file(str(folder / 'vehicle.yaml'))
    file = read_scene(open_flight(find_bag(folder)).provenance).vehicle
    if file is None:
        raise BadInput(f'{source} has no vehicle file; give the path of one.')
    return file


def write_skeleton(name: str, law: Law | None, folder: Path) -> list[Path]:
    """
    Write `NAME.py` and `pyproject.toml` into a new folder, and return their paths.

    Raise `BadInput` if the name is not free or valid, the folder exists, or the law cannot be an
    effect.
    """
    if not name.isidentifier() or name != name.lower() or name != name.strip('_'):
        raise BadInput(
            f"'{name}' cannot name an effect; use small letters and digits, with underscores "
            'between.'
        )
    if name in MODEL_EFFECTS:
        raise BadInput(f'There is an effect {name} already; choose another name.')
    # The file is installed as a module of this name
    if keyword.iskeyword(name) or find_spec(name):
        raise BadInput(
            f"'{name}' cannot name an effect, as Python has a keyword or module of this name; "
            'choose another name.'
        )
    text = render_skeleton(name, law)
    if folder.exists():
        raise BadInput(f'{folder} exists already; give another folder with --out.')
    folder.mkdir(parents=True)
    files = {folder / f'{name}.py': text, folder / 'pyproject.toml': PROJECT.substitute(name=name)}
    for path, content in files.items():
        path.write_text(content, encoding='utf-8')
    return list(files)


def render_skeleton(name: str, law: Law | None) -> str:
    """
    Return the Python file of an effect that computes what a law does; without one, an example.

    Raise `BadInput` if the hidden state of the law follows the thrust, which the rate of an effect
    does not get.
    """
    writer = _SkeletonWriter(law or EXAMPLE, fades=law is not None)
    return FILE.substitute(
        writer.fill_template(),
        name=name,
        title='The formula of a law, to be replaced by the equations of its cause'
        if law
        else 'What the effect is, in one sentence',
    )


class _SkeletonWriter:
    """Write the parts of the file of an effect that computes what a law does."""

    def __init__(self, law: Law, *, fades: bool) -> None:
        self._law, self._fades = law, fades
        axes = [term.axis for term in law.terms]
        self._coefficients = [f'{axis}_{axes[: k + 1].count(axis)}' for k, axis in enumerate(axes)]
        hidden = law.hidden
        self._lags = {} if hidden is None else hidden.model_dump(exclude_none=True)
        self._lags.pop('drive', None)
        self._start = self._lags.pop('start', 0.0)
        self._remembers = bool(hidden) or 'time' in law.quantities
        if hidden and (pushed := [one for one in law.quantities if one.startswith('thrust')]):
            raise BadInput(
                f'The hidden state of the law depends on {", ".join(pushed)}, which the rate of '
                'an effect does not get; fly the law itself, or begin with an empty skeleton.'
            )

    def fill_template(self) -> dict[str, object]:
        """Return the parts of the file."""
        law = self._law
        placed = any(one in PLACED for one in (*law.quantities, *(t.axis for t in law.terms)))
        memory = (
            f"\n    memory=(('hidden', {self._start!r}), ('hidden_rate', 0.0), ('time', 0.0)),"
            '\n    rate=compute_memory_rate,'
        )
        return {
            'about': '\n'.join(f'        {line}' for line in describe_law(law)),
            'parameters': '\n'.join(self._list_parameters()),
            'unpack': self._unpack,
            'quantities': '\n'.join(self._list_quantities()),
            'sums': '\n'.join(self._list_sums()),
            'rate': self._write_rate() if self._remembers else '',
            'linear': _format_names([f"'{one}'" for one in self._coefficients]),
            'memory': memory if self._remembers else '',
            'placed': placed,
        }

    @property
    def _unpack(self) -> str:
        """The names of the parameters, as a tuple."""
        return _format_names([*self._coefficients, *self._lags])

    def _list_parameters(self) -> Iterator[str]:
        """Yield the declarations of the parameters."""
        for name, term in zip(self._coefficients, self._law.terms, strict=True):
            size = abs(term.coefficient) or 1.0
            low, high = term.interval or (0.0, 0.0)
            # Half of a 95 % interval is 1.96 standard deviations
            spread = (high - low) / 3.92 or SPREAD * size
            # Of a unit that files do not have: at factors of 1
            unit = term.unit if term.unit in UNITS else AXES[term.axis]
            yield (
                f"    EffectParameter('{name}', '{unit}', 0.0, {-REACH * size:.3g}, "
                f'{REACH * size:.3g}, {spread:.3g}, '
                f"'{term.coefficient:.6g} in a law; give the source of bounds and spread'),"
            )
        for name, value in self._lags.items():
            unit = {'time_constant': 's', 'frequency': 'rad/s', 'damping': '1'}[name]
            yield (
                f"    EffectParameter('{name}', '{unit}', 0.0, 0.0, {REACH * (value or 1.0):.3g}, "
                f'{SPREAD * (value or 1.0):.3g}, '
                f"'{value:.6g} in a law; give the source of bounds and spread', beside={value!r}),"
            )

    def _list_quantities(self) -> Iterator[str]:
        """Yield the lines that compute all quantities, and the fade by them."""
        yield from self._list_outer_quantities()
        own = [name for name in (HIDDEN, HIDDEN_RATE) if name in self._law.quantities]
        for name in own:
            source = EXPRESSIONS[name]
            if name == HIDDEN_RATE and 'time_constant' in self._lags:
                # The null value of the lag is 0
                source = f'({self._drive} - memory[0]) / max(time_constant, {LEAST_LAG})'
            yield f'    {name} = {source}'
        if own and self._fades:
            yield f'    within = {" * ".join(["within", *self._list_fades(own)])}'

    def _list_outer_quantities(self) -> Iterator[str]:
        """Yield the lines that compute what does not depend on the hidden state, and its fade."""
        outer = [name for name in self._law.quantities if name not in (HIDDEN, HIDDEN_RATE)]
        for name in outer:
            yield f'    {_local_name(name)} = {EXPRESSIONS[name]}'
        if self._fades:
            yield f'    within = {" * ".join(self._list_fades(outer)) or "1.0"}'

    def _list_fades(self, names: Sequence[str]) -> list[str]:
        """Return the source of the fading factor of each quantity."""
        return [
            f'fade({_unwrap(name, low, high)}, {low!r}, {high!r})'
            for name, (low, high) in self._law.region.items()
            if name in names
        ]

    @property
    def _drive(self) -> str:
        """The drive of the hidden state as source."""
        factors = self._law.hidden.drive if self._law.hidden else []
        product = ' * '.join(map(format_factor_source, factors))
        return f'within * {product}' if self._fades else product

    def _list_sums(self) -> Iterator[str]:
        """Yield the lines that compute the wrench."""
        for axis, unit in AXES.items():
            parts = [
                ' * '.join([name, *map(format_factor_source, term.factors)])
                for name, term in zip(self._coefficients, self._law.terms, strict=True)
                if term.axis == axis
            ]
            total = ' + '.join(parts) or '0.0'
            faded = f'within * ({total})' if parts and self._fades else total
            yield f'    {axis}{"_moment" if unit == "N m" else ""} = {faded}'

    def _write_rate(self) -> str:
        """Return the function of the rates of the memory."""
        off = ' and '.join(f'{one} == 0.0' for one in self._coefficients)
        hidden = self._law.hidden
        if hidden is None:
            drive, rates = '0.0', '(0.0, 0.0, 1.0)'
        else:
            drive = self._drive
            off = f'{next(iter(self._lags))} == 0.0'
            rates = (
                '((drive - memory[0]) / time_constant, 0.0, 1.0)'
                if hidden.time_constant is not None
                else '(\n        memory[1],\n        frequency * frequency * (drive - memory[0])'
                '\n        - 2.0 * damping * frequency * memory[1],\n        1.0,\n    )'
            )
        return RATE.substitute(
            unpack=self._unpack,
            absent=off,
            # The drive fades without the hidden state, as in the law
            quantities='\n'.join(self._list_outer_quantities()) if hidden else '',
            drive=f'    drive = {drive}\n    return {rates}',
        )


def _format_names(names: list[str]) -> str:
    """Return a tuple of any length as source."""
    return f'({", ".join(names)}{"," if len(names) == 1 else ""})'


def _local_name(quantity: str) -> str:
    """Return the variable of a quantity; `p` holds the parameters."""
    return f'rate_{quantity}' if quantity in ('p', 'q', 'r') else quantity


def _unwrap(quantity: str, low: float, high: float) -> str:
    """Return a quantity as source; a heading within half a turn of the middle of its range."""
    if quantity != 'yaw':
        return _local_name(quantity)
    return (
        f'yaw - 2.0 * math.pi * math.floor((yaw - {0.5 * (low + high)!r}) / (2.0 * math.pi) + 0.5)'
    )


def format_factor_source(factor: LawFactor) -> str:
    """Return a factor as Python source."""
    x = _local_name(factor.quantity)
    exponent, threshold = factor.exponent or 1.0, factor.threshold or 0.0
    scale = factor.scale or PERIOD
    angle = f'2.0 * math.pi * {x} / {scale!r} - {factor.phase or 0.0!r}'
    return {
        'linear': x,
        'modulus': f'math.pow(abs({x}), {exponent!r})' if exponent != 1.0 else f'abs({x})',
        'power': f'math.copysign(math.pow(abs({x}), {exponent!r}), {x})',
        'positive': f'max({x} - {threshold!r}, 0.0)',
        'negative': f'max({threshold!r} - {x}, 0.0)',
        'above': f'0.5 * (1.0 + math.tanh(({x} - {threshold!r}) / {scale!r}))',
        'sign': f'math.tanh({x} / {scale!r})',
        'decay': f'math.exp(min(-{x} / {scale!r}, {LARGEST_EXPONENT!r}))',
        'sin': f'math.sin({angle})',
        'cos': f'math.cos({angle})',
    }[factor.form]
