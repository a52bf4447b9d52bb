# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Generate the stages of the state derivative: a few lines of source per effect.

The order is physical: air, actuators, wrenches, then the acceleration of the body. Stages pass on
local variables: `r`, the rotation matrix, `ground`, the velocity in the map, `wind` and its rate
`flow`, `airspeed`, `u`, duties and then thrusts, and `total`, the wrench. Rotors are a loop, or
unrolled lines for targets without arrays: a loop needs an eighth of the source to compile, and is
vectorised over one vehicle's rotors.
"""

from typing import final

from lta_config.compilation.extract import SourceExtract
from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    no_rate,
    no_rotor_rate,
    WrenchEffect,
)
from lta_model.state import ACTUATORS, WIND, WIND_RATE
from lta_sim.kernels.layout import EffectLayout, format_tuple, KernelAccess, ModelStage


def build_command_stage(layout: EffectLayout, access: KernelAccess) -> ModelStage:
    """Return the first actuator stage: the commanded duties."""
    if access.loops:
        line = (
            f'{access.format_number("u", 0, layout, 1)} = '
            f'{access.format_number("command", 0, layout, 1)}'
        )
        return ModelStage((line,), each=True)
    duties = format_tuple(access.format_number('command', i, layout) for i in range(ACTUATORS))
    return ModelStage((f'u = {duties}',), actuates=True)


def _format_rotor_inputs(
    name: str, effect: ActuatorEffect, layout: EffectLayout, access: KernelAccess, rotor: int = 0
) -> list[str]:
    """Return the lines that load an effect's inputs of one rotor: of rotor j in a loop."""
    size, j = len(effect.memory), int(access.loops)
    # Parameter layout: shared ones first, then each per-rotor parameter for all rotors
    first, shared = layout.first[name], len(effect.shared)
    each = [first + shared + k * ACTUATORS + rotor for k in range(len(effect.each))]
    memory = [layout.remembers[name] + rotor * size + k for k in range(size)]
    p = [access.format_number('parameters', first + k, layout) for k in range(shared)]
    p += [access.format_number('parameters', place, layout, j) for place in each]
    m = [access.format_number('state', place, layout, j * size) for place in memory]
    return [f'p = {format_tuple(p)}', f'm = {format_tuple(m)}']


def build_actuator_stage(
    name: str,
    effect: ActuatorEffect,
    layout: EffectLayout,
    access: KernelAccess,
    extract: SourceExtract,
) -> ModelStage:
    """Return the stage of an actuator effect for all rotors."""
    output = extract.add_function(effect.output, name)
    rate = '' if effect.rate is no_rotor_rate else extract.add_function(effect.rate, name)
    around = access.format_all_numbers('surroundings', layout)
    size, first = len(effect.memory), layout.remembers[name]
    if access.loops:
        u = access.format_number('u', 0, layout, 1)
        lines = [*_format_rotor_inputs(name, effect, layout, access), f'duty = {u}']
        if rate:
            lines.append(f'R = {rate}(p, m, duty, {around})')
            lines += [
                f'{access.format_number("rate", first + k, layout, size)} = R[{k}]'
                for k in range(size)
            ]
        lines.append(f'{u} = {output}(p, m, duty, {around})')
        return ModelStage(tuple(lines), name, each=True)
    lines, rates = [], []
    for i in range(ACTUATORS):
        lines += _format_rotor_inputs(name, effect, layout, access, i)
        if rate:
            lines.append(f'r_{i} = {rate}(p, m, u[{i}], {around})')
            rates += [f'r_{i}[{k}]' for k in range(size)]
        lines.append(f'u_{i} = {output}(p, m, u[{i}], {around})')
    if rate:
        lines.append(f'R_{name} = {format_tuple(rates)}')
    lines.append(f'u = {format_tuple(f"u_{i}" for i in range(ACTUATORS))}')
    return ModelStage(tuple(lines), name, actuates=True)


@final
class _StageWriter:
    """Generate the stages for one compilation target."""

    def __init__(self, layout: EffectLayout, access: KernelAccess, extract: SourceExtract) -> None:
        self._layout = layout
        self._access = access
        self._extract = extract

    def format_numbers(self, name: str, first: int, count: int) -> str:
        """Return the source of a tuple of consecutive numbers."""
        items = (self._access.format_number(name, first + k, self._layout) for k in range(count))
        return format_tuple(items)

    def format_motion(self) -> str:
        """Return the source of the motion for wrench effects."""
        body, command, around = (
            self._access.format_all_numbers(name, self._layout)
            for name in ('body', 'command', 'surroundings')
        )
        position, v, w = (
            self.format_numbers('state', 0, 3),
            self.format_numbers('state', 7, 3),
            self.format_numbers('state', 10, 3),
        )
        seen = f'{position}, r, {v}, {w}, airspeed, {body}, {command}, {around}'
        return f'motion = rigid_body_build_motion({seen})'

    def build_attitude_stage(self) -> ModelStage:
        """Return the first stage: attitude and initial values."""
        lines = (
            # State: position 0..2, quaternion 3..6, velocity 7..9, rates 10..12
            f'r = rigid_body_rotation_matrix({self.format_numbers("state", 3, 4)})',
            f'ground = rigid_body_to_map(r, {self.format_numbers("state", 7, 3)})',
            f'wind = {self.format_numbers("surroundings", WIND, 3)}',
            f'flow = {self.format_numbers("surroundings", WIND_RATE, 3)}',
            'total = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)',
        )
        return ModelStage(lines)

    def build_airspeed_stage(self) -> ModelStage:
        """Return the velocity through the air."""
        v = self.format_numbers('state', 7, 3)
        return ModelStage((f'airspeed = rigid_body_airspeed(r, {v}, wind)',))

    def build_acceleration_stage(self) -> ModelStage:
        """Return the last stage: the rate of the rigid body."""
        q, w = self.format_numbers('state', 3, 4), self.format_numbers('state', 10, 3)
        inverse = self._access.format_all_numbers('inverse', self._layout)
        lines = (
            'f = ground',
            f'g = rigid_body_quaternion_rate({q}, {w})',
            f'a = rigid_body_body_acceleration(total, motion, flow, {inverse})',
        )
        names = [*(f'f[{i}]' for i in range(3)), *(f'g[{i}]' for i in range(4))]
        places = enumerate([*names, *(f'a[{i}]' for i in range(6))])
        return ModelStage(lines, memory=tuple(places))

    def _format_inputs(self, name: str, effect: AirEffect | WrenchEffect) -> list[str]:
        """Return the lines that load an effect's parameters and memory."""
        layout = self._layout
        return [
            f'p = {self.format_numbers("parameters", layout.first[name], len(effect.parameters))}',
            f'm = {self.format_numbers("state", layout.remembers[name], len(effect.memory))}',
        ]

    def _memory_rates(self, name: str, count: int) -> tuple[tuple[int, str], ...]:
        """Return the destinations and sources of the rates of an effect's memory."""
        first = self._layout.remembers[name]
        return tuple((first + k, f'R_{name}[{k}]') for k in range(count))

    def build_air_stage(self, name: str, effect: AirEffect) -> ModelStage:
        """Return the stage of an air effect."""
        around, position = (
            self._access.format_all_numbers('surroundings', self._layout),
            self.format_numbers('state', 0, 3),
        )
        lines = [
            *self._format_inputs(name, effect),
            f'place = rigid_body_build_air_input({position}, ground, wind, {around})',
            f'U = {self._extract.add_function(effect.air, name)}(p, m, place)',
            # Air effects return velocity (0..2) and its rate (3..5), both in the map
            'wind = (wind[0] + U[0], wind[1] + U[1], wind[2] + U[2])',
            'flow = (flow[0] + U[3], flow[1] + U[4], flow[2] + U[5])',
        ]
        count = len(effect.memory)
        if effect.rate is not no_rate:
            lines.append(
                f'R_{name} = {self._extract.add_function(effect.rate, name)}(p, m, place)'
            )
        return ModelStage(tuple(lines), name, self._memory_rates(name, count))

    def build_wrench_stage(self, name: str, effect: WrenchEffect) -> ModelStage:
        """Return the stage of a wrench effect."""
        count = len(effect.memory)
        lines = [
            *self._format_inputs(name, effect),
            f'W_{name} = {self._extract.add_function(effect.wrench, name)}(p, m, motion, u)',
            f'total = rigid_body_add_wrenches(total, W_{name})',
        ]
        if effect.rate is not no_rate:
            lines.append(
                f'R_{name} = {self._extract.add_function(effect.rate, name)}(p, m, motion)'
            )
        return ModelStage(tuple(lines), name, self._memory_rates(name, count))


def build_stages(
    layout: EffectLayout, access: KernelAccess, extract: SourceExtract
) -> list[ModelStage]:
    """Return the stages of the state derivative in order; `extract` collects their functions."""
    writer = _StageWriter(layout, access, extract)
    kinds = list(layout.effects.items())
    return [
        writer.build_attitude_stage(),
        *(writer.build_air_stage(name, e) for name, e in kinds if isinstance(e, AirEffect)),
        writer.build_airspeed_stage(),
        build_command_stage(layout, access),
        *(
            build_actuator_stage(name, effect, layout, access, extract)
            for name, effect in kinds
            if isinstance(effect, ActuatorEffect)
        ),
        ModelStage((f'u = {access.format_all_numbers("u", layout)}', writer.format_motion())),
        *(writer.build_wrench_stage(name, e) for name, e in kinds if isinstance(e, WrenchEffect)),
        writer.build_acceleration_stage(),
    ]
