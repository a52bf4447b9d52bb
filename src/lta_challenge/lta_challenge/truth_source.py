"""Generate the source of the truth simulator: own equations and effect functions."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

from lta_challenge.truth_equations import TruthConstants, TruthKernel, TruthWork
from lta_challenge.truth_flight import fly_truth, PilotConstants, PilotInputs
from lta_config.compilation.extract import SourceExtract
from lta_config.compilation.flat import CORE_PREFIX
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    AirEffectInput,
    KernelEffect,
    no_rate,
    no_rotor_rate,
    WrenchEffect,
)
from lta_model.state import ACTUATORS
from lta_sim.kernels.layout import indent_lines

# Effects that the truth implements itself, or that do not occur in free flight of a bare hull
APART: Final = frozenset(
    {
        'weight_and_buoyancy', 'rotor_thrust', 'rotor_misalignment', 'floor_contact', 'walls',
        'wind_profile', 'turbulence', 'gusts', 'superheat', 'moving_mass', 'hull_lift',
        'thrust_polynomial', 'rotor_envelope_interaction', 'ceiling_effect',
        'battery_compensation', 'law',
    }
)  # fmt: skip
HEAD: Final = '''"""The truth of a challenge, composed; edits here are lost."""

from collections import namedtuple
import math

from numba import njit


'''
RIGID: Final = 18  # position, rotation matrix, momentum, angular momentum


def _tuple_source(name: str, first: int, count: int) -> str:
    """Return the source text of a tuple of adjacent array elements."""
    return '(' + ''.join(f'{name}[{first + k}], ' for k in range(count)).rstrip() + ')'


@final
@dataclass(frozen=True, slots=False)
class TruthModel:
    """The effects of the truth simulator and the layout of its arrays."""

    effects: Mapping[str, KernelEffect]  # effects of the library
    strange: Mapping[str, WrenchEffect]  # effects outside the library

    @cached_property
    def all_effects(self) -> dict[str, KernelEffect]:
        """All effects, those of the library first."""
        return {**self.effects, **self.strange}

    @cached_property
    def parameter_offsets(self) -> dict[str, int]:
        """Index of the first parameter of each effect."""
        out, count = {}, 0
        for name, effect in self.all_effects.items():
            out[name] = count
            count += len(effect.parameters)
        return out

    @cached_property
    def memory_offsets(self) -> dict[str, int]:
        """Index of the first memory element of each effect in the state."""
        out, count = {}, RIGID
        for name, effect in self.all_effects.items():
            out[name] = count
            # Actuator effects have a memory for each rotor
            each = ACTUATORS if isinstance(effect, ActuatorEffect) else 1
            count += each * len(effect.memory)
        return out

    @cached_property
    def initial_memory(self) -> tuple[float, ...]:
        """Initial values of all memories."""
        return tuple(
            value
            for effect in self.all_effects.values()
            for _ in range(ACTUATORS if isinstance(effect, ActuatorEffect) else 1)
            for _, value in effect.memory
        )

    @property
    def state_size(self) -> int:
        """Number of elements in the state."""
        return RIGID + len(self.initial_memory)

    def flag_index(self, name: str) -> int:
        """Return the index of an effect's flag."""
        return list(self.all_effects).index(name)

    def _air_lines(self, extract: SourceExtract) -> list[str]:
        """Return the source lines that sum the wind."""
        lines = []
        for name, effect in self.all_effects.items():
            if isinstance(effect, AirEffect):
                p = _tuple_source('p', self.parameter_offsets[name], len(effect.parameters))
                call = extract.add_function(effect.air, name)
                place = extract.add_named_tuple(AirEffectInput)
                lines += [
                    f'if on[{self.flag_index(name)}]:',
                    f'    e = {call}({p}, (), {place}(at, still, (u, v, w), around))',
                    '    u, v, w = u + e[0], v + e[1], w + e[2]',
                ]
        return lines

    def _actuator_lines(self, extract: SourceExtract) -> list[str]:
        """Return the source lines that convert a command to the thrust of one rotor."""
        lines = []
        for name, effect in self.all_effects.items():
            if not isinstance(effect, ActuatorEffect):
                continue
            first, shared = self.parameter_offsets[name], len(effect.shared)
            # First the parameters shared by all rotors, then a block for each per-rotor parameter
            parts = [f'p[{first + k}]' for k in range(shared)]
            parts += [f'p[{first + shared + ACTUATORS * k} + j]' for k in range(len(effect.each))]
            size, place = len(effect.memory), self.memory_offsets[name]
            memory = ''.join(f'y[{place + k} + {size} * j], ' for k in range(size)).rstrip()
            lines += [
                f'if on[{self.flag_index(name)}]:',
                f'    q = ({", ".join(parts)},)',
                f'    m = ({memory})',
                '    given = value',
                f'    value = {extract.add_function(effect.output, name)}(q, m, given, around)',
            ]
            if effect.rate is not no_rotor_rate:
                lines.append(
                    f'    e = {extract.add_function(effect.rate, name)}(q, m, given, around)'
                )
                lines += [f'    dy[{place + k} + {size} * j] = e[{k}]' for k in range(size)]
        return lines

    def _wrench_lines(self, extract: SourceExtract) -> list[str]:
        """Return the source lines that sum forces and moments."""
        lines = []
        for name, effect in self.all_effects.items():
            if not isinstance(effect, WrenchEffect):
                continue
            p = _tuple_source('p', self.parameter_offsets[name], len(effect.parameters))
            m = _tuple_source('y', self.memory_offsets[name], len(effect.memory))
            lines += [
                f'if on[{self.flag_index(name)}]:',
                f'    q, m = {p}, {m}',
                f'    e = {extract.add_function(effect.wrench, name)}(q, m, motion, u)',
            ]
            # Record the wrench of effects outside the library separately, to measure its strength
            if name in self.strange:
                lines.append('    for k in range(6): extra[k] += e[k]')
            else:
                lines.append('    f0, f1, f2 = f0 + e[0], f1 + e[1], f2 + e[2]')
                lines.append('    n0, n1, n2 = n0 + e[3], n1 + e[4], n2 + e[5]')
            if effect.rate is not no_rate:
                lines.append(f'    e = {extract.add_function(effect.rate, name)}(q, m, motion)')
                place = self.memory_offsets[name]
                lines += [f'    dy[{place + k}] = e[{k}]' for k in range(len(effect.memory))]
        return lines

    def render_simulator_source(self, own: str, entry: str, rotors: int) -> str:
        """
        Generate the source of the simulator, whose entry is `core_fly_truth`.

        `own`, `entry`: decorators of internal functions, and of `truth_flight.fly_truth`.
        `rotors`: number of rotors.
        """
        extract = SourceExtract(kernel=TruthKernel(rotors, self.state_size))
        name = extract.add_function(fly_truth, CORE_PREFIX)
        # Python passes these in; in the text, their fields are part of the key of the cache
        for kind in (TruthConstants, TruthWork, PilotConstants, PilotInputs):
            extract.add_named_tuple(kind)
        generated = [
            self._render_wind(extract),
            self._render_wind_flag(),
            self._render_thrusts(extract, rotors),
            self._render_wrenches(extract),
        ]
        functions = '\n\n\n'.join(f'{own}\n{text}' for text in generated)
        return f'{HEAD}{extract.render_pieces(own, entry, [name])}\n\n\n{functions}\n'

    def _render_wind(self, extract: SourceExtract) -> str:
        """Return the source of `TruthKernel.wind_at`."""
        lines = [
            'u, v, w = 0.0, 0.0, 0.0',
            'at, still = (x, y, z), (0.0, 0.0, 0.0)',
            *self._air_lines(extract),
            'return u, v, w',
        ]
        return f'def wind_at(x, y, z, p, on, around):\n{indent_lines(lines)}'

    def _render_wind_flag(self) -> str:
        """Return the source of `TruthKernel.is_windy`."""
        flags = [
            f'on[{self.flag_index(n)}]'
            for n, e in self.all_effects.items()
            if isinstance(e, AirEffect)
        ]
        return f'def is_windy(on):\n    return {" or ".join(flags) or False}'

    def _render_thrusts(self, extract: SourceExtract, rotors: int) -> str:
        """Return the source of `TruthKernel.write_thrusts`."""
        lines = ['value = told[j]', *self._actuator_lines(extract), 'u[j] = value']
        head = f'def write_thrusts(y, dy, told, p, on, around, u):\n    for j in range({rotors}):'
        return f'{head}\n{indent_lines(lines, 2)}'

    def _render_wrenches(self, extract: SourceExtract) -> str:
        """Return the source of `TruthKernel.add_wrenches`."""
        lines = [*self._wrench_lines(extract), 'return f0, f1, f2, n0, n1, n2']
        arguments = 'f0, f1, f2, n0, n1, n2, y, dy, p, on, motion, u, extra'
        return f'def add_wrenches({arguments}):\n{indent_lines(lines)}'


def library_effects() -> dict[str, KernelEffect]:
    """Return the library effects whose equations the truth uses."""
    return {
        name: effect
        for name, effect in EFFECTS.items()
        if isinstance(effect, KernelEffect) and name not in APART
    }
