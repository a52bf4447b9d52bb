# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define a flight: its files as read, with single parameters replaced.

The first word of a parameter's path is its file or settings. `vehicle`, `scenario` and `gains` are
files; the others are the parameters of a node. A path that is only the name of a file, or
`strategy`, replaces the whole file or the strategy.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import (
    format_value,
    get_parameter,
    parse_quantity,
    replace_parameter,
)
from lta_config.quantity import SI_UNITS
from lta_config.schema.vehicle_file import load_vehicle_content, VehicleFile
from lta_config.settings import Settings
from lta_config.topics import load_topic_table
from lta_control.guidance import check_reserve
from lta_control.laws import CASCADE, find_control_law
from lta_control.laws.cascade import CascadeGains
from lta_control.strategies import check_route, find_navigation_strategy
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_stack import FlightStack
from lta_flight.recorded_choices import SETTABLE
from lta_model.scenario import resolve_wind_file, Scenario
from lta_model.vehicle import Vehicle
from lta_sim import scene_model
from lta_sim.world import World
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.spectrum import plan_beacon_bins
from pydantic import BaseModel
import yaml

SPEC_FILES = ('vehicle', 'scenario', 'gains')
SPEC_SETTINGS: dict[str, type[Settings]] = {
    'gains': CascadeGains,
    **{root: block.model for root, block in SETTABLE.items()},
}
DEFAULT_GAINS = 'gtmab'  # for a vehicle that does not name its own
NAMED_ROOTS = ('strategy', *SPEC_FILES)  # paths of one word, which replace a whole file
SPEC_ROOTS = (*SPEC_FILES, *(name for name in SPEC_SETTINGS if name not in SPEC_FILES))


@final
@dataclass(frozen=True, slots=True)
class FlightSpec:
    """Everything that determines a flight except its seed."""

    names: Mapping[str, str]  # names or paths of the files, by root
    strategy: str  # navigation strategy
    contents: Mapping[str, Any]  # contents of the files and settings as YAML has them, by root
    replaced: Mapping[str, Any] = field(default_factory=dict)  # replaced parameters, by path

    def with_values(self, values: Mapping[str, Any]) -> 'FlightSpec':
        """
        Return a copy with parameters replaced, by path; raise `BadInput` for an invalid one.

        If a file is replaced, earlier replacements are applied to the new file.
        """
        other = {path: value for path, value in values.items() if path in NAMED_ROOTS}
        if other:
            rest = {path: value for path, value in values.items() if path not in NAMED_ROOTS}
            return self._with_files(other).with_values({**self.replaced, **rest})
        contents = dict(self.contents)
        for path, value in values.items():
            root, below = split_path(path)
            contents[root] = replace_parameter(contents[root], below, value, root)
        return replace(self, contents=contents, replaced={**self.replaced, **values})

    def _with_files(self, names: Mapping[str, Any]) -> 'FlightSpec':
        """Return the flight with other files or another strategy, without replaced parameters."""
        for path, name in names.items():
            if not isinstance(name, str):
                raise BadInput(
                    f'{path} is {format_value(name)}, but must be a name or the path of a file.'
                )
        # An empty name selects the gains of the new vehicle
        own = {} if 'vehicle' not in names else {'gains': ''}  # another vehicle, its own gains
        named = {'strategy': self.strategy, **self.names, **own, **names}
        return load_spec(named['vehicle'], named['scenario'], named['strategy'], named['gains'])

    def read_value(self, path: str) -> Any:
        """Return the value at a path; None for an omitted parameter of an effect."""
        if path in NAMED_ROOTS:
            return {'strategy': self.strategy, **self.names}[path]
        root, below = split_path(path)
        return get_parameter(self.contents[root], below, root)

    def find_unit(self, path: str) -> str:
        """Return the SI unit of a parameter; '' if it has none."""
        quantity = parse_quantity(self.read_value(path))
        if quantity is not None:
            # An unknown unit is reported later, by validation
            return SI_UNITS.get(quantity['unit'], (quantity['unit'],))[0]
        if path in NAMED_ROOTS:
            return ''
        root, below = split_path(path)
        models = select_settings_models(self.contents['vehicle'])
        return declared_unit(models[root], below.split('.')) if root in models else ''


def split_path(path: str) -> tuple[str, str]:
    """Return the root of a path and the rest."""
    root, _, below = path.partition('.')
    if root not in SPEC_ROOTS or not below:
        raise unknown_name_error(
            'parameter', path, [*NAMED_ROOTS, *(f'{name}. ...' for name in SPEC_ROOTS)]
        )
    return root, below


def declared_unit(model: type[BaseModel], keys: list[str]) -> str:
    """Return the declared unit of a setting; '' if it has none."""
    declared = model.model_fields.get(keys[0])
    if declared is None:
        return ''
    if len(keys) > 1:
        inner = declared.annotation
        is_model = isinstance(inner, type) and issubclass(inner, BaseModel)
        return declared_unit(inner, keys[1:]) if is_model else ''  # type: ignore[arg-type]
    extra = declared.json_schema_extra
    return str(extra.get('unit', '')) if isinstance(extra, dict) else ''


def load_spec(vehicle: str, scenario: str, strategy_name: str, gains: str) -> FlightSpec:
    """
    Read the files of a flight.

    `vehicle`, `scenario`, `gains`: shipped names or paths; without gains, those that the vehicle's
    file names. `strategy_name`: navigation strategy. Raise `BadInput` if a file cannot be read or
    a name is unknown.
    """
    find_navigation_strategy(strategy_name)
    content = load_vehicle_content(find_file('vehicle', vehicle))
    own = read_control(content).get('gains', DEFAULT_GAINS)
    names = {'vehicle': vehicle, 'scenario': scenario, 'gains': gains or own}
    contents = {root: load_yaml(find_file(root, name)) for root, name in names.items()}
    contents['vehicle'] = content
    contents['scenario'] = resolve_wind_file(
        contents['scenario'], find_file('scenario', scenario).parent
    )
    contents['gains'] = read_gains(contents['gains'], names['gains'])
    for root, model in SPEC_SETTINGS.items():
        # Nodes have no files here, so their settings start at the defaults
        contents.setdefault(root, model().model_dump() if root != 'gains' else None)
    return FlightSpec(names, strategy_name, contents)


def read_control(content: Any) -> dict[str, str]:
    """Return law and gains that a vehicle's file names, as far as they are text."""
    control = content.get('control') if isinstance(content, dict) else None
    block = control if isinstance(control, dict) else {}
    return {key: word for key, word in block.items() if isinstance(word, str)}


def select_settings_models(vehicle: Any) -> dict[str, type[Settings]]:
    """Return the models of all settings; the gains are those of the vehicle's control law."""
    return SPEC_SETTINGS | {
        'gains': find_control_law(read_control(vehicle).get('law', CASCADE)).gains
    }


def read_gains(content: Any, name: str) -> Any:
    """Return the gains from a ROS parameter file."""
    try:
        return content['/**/controller']['ros__parameters']['gains']
    except (KeyError, TypeError):
        raise BadInput(
            f'{find_file("gains", name)} has no gains under /**/controller, ros__parameters, '
            'gains; compare it with a file in config/control.'
        ) from None


def build_vehicle_scenario_stack(
    spec: FlightSpec, hovers: bool = True
) -> tuple[Vehicle, Scenario, FlightStack]:
    """
    Return vehicle, scenario and flight stack; `hovers` if the rotors must lift the vehicle.

    Raise `BadInput` if a part is invalid, or the parts do not fit together.
    """
    scenario = _validate_part(Scenario, spec, 'scenario')
    vehicle_file = _validate_part(VehicleFile, spec, 'vehicle')
    models = select_settings_models(spec.contents['vehicle'])
    gains, mission, reserve, estimator, demodulation, prior, energy = (
        _validate_part(model, spec, root) for root, model in models.items()
    )
    policy = FlightStack(
        strategy=find_navigation_strategy(spec.strategy),
        gains=gains,
        mission=mission,
        estimator=estimator,
        demodulation=demodulation,
        prior=prior,
        energy=energy,
        reserve=reserve,
        law=find_control_law(vehicle_file.control.law if vehicle_file.control else CASCADE),
    )
    check_route(policy.strategy, len(scenario.route))
    check_lamp_frequency(scenario, policy.demodulation)
    check_reserve(policy.reserve, policy.strategy)
    vehicle = Vehicle(vehicle_file, scenario.air.density)
    if hovers:
        # Evaluated for its check: raises BadInput if the rotors cannot lift the vehicle
        _ = vehicle.hover_duty
    scene_model.check_scene(vehicle, scenario, hovers)
    return vehicle, scenario, policy


def build_loop(spec: FlightSpec, seed: int) -> ClosedLoop:
    """Return a flight that is ready to start; raise `BadInput` if it is invalid."""
    vehicle, scenario, policy = build_vehicle_scenario_stack(spec)
    table = load_topic_table()
    world = World(vehicle, scenario, table, seed, spec.strategy)
    return ClosedLoop(world, table, policy)


def _validate_part(model: type[Any], spec: FlightSpec, root: str) -> Any:
    """Return one validated part; errors name its file and the replaced parameters."""
    where = (
        str(find_file(root, spec.names[root])) if root in SPEC_FILES else f'the settings of {root}'
    )
    replaced = [path for path in spec.replaced if path.startswith(f'{root}.')]
    if replaced:
        where += f' with {", ".join(replaced)} set'
    return validate_content(model, spec.contents[root], where)


def write_files(spec: FlightSpec, folder: Path) -> dict[str, str]:
    """Write files with replaced parameters; return the paths or names of all files by root."""
    names = dict(spec.names)
    for root in SPEC_FILES:
        if any(path.startswith(f'{root}.') for path in spec.replaced):
            content = spec.contents[root]
            if root == 'gains':
                # Back to the ROS parameter file that `read_gains` reads
                content = {'/**/controller': {'ros__parameters': {'gains': content}}}
            path = folder / f'{root}.yaml'
            path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
            names[root] = str(path)
    return names


def to_set_args(values: Mapping[str, Any]) -> Iterable[str]:
    """Return replaced parameters as arguments of `lta simulate --set`."""
    for path, value in values.items():
        quantity = parse_quantity(value)
        yield f'{path}={value}' if quantity is None else f'{path}={format_quantity(quantity)}'


def format_quantity(quantity: Mapping[str, Any]) -> str:
    """Return a quantity as text that can be read back exactly."""
    number = quantity['value']
    if isinstance(number, list | tuple):
        return f'{list(number)} {quantity["unit"]}'
    # repr of a float keeps all its bits
    return f'{number!r} {quantity["unit"]}'


def check_lamp_frequency(scenario: Scenario, demodulation: DemodulationSettings) -> None:
    """
    Reject a scene whose lamp is outside the demodulator's search window.

    On a route the navigator requests the frequency of each lamp, and on a course no lamp is
    searched. Otherwise the demodulator uses its own setting, and such a flight would only time
    out.

    Raise `BadInput` if the lamp's nominal frequency is outside the window of bins of the first
    beacon.
    """
    if scenario.route or scenario.course is not None:
        return
    light = load_topic_table().light
    rate, samples = light.sample_rate.si, light.samples
    # The first beacon is the demodulator's own frequency
    low, high = plan_beacon_bins(demodulation.beacons, demodulation, rate, samples)[
        0
    ].frequency_limits
    lamp = scenario.goal_lamp.frequency.si
    if not low <= lamp <= high:
        name = next(iter(scenario.lamps))
        raise BadInput(
            f'The lamp of {scenario.name} flickers at {lamp:g} Hz, but the demodulator listens '
            f'at {demodulation.frequency:g} Hz ({low:.0f} to {high:.0f} Hz); set '
            f"demodulator.frequency, or add 'route: [{name}]' to the scenario, so that the "
            'demodulator uses the frequency of each lamp.'
        )
