"""
What a flight is made of: its files as they are read, with single parameters replaced.

The first word of a parameter's path says which file or settings it belongs to: `vehicle`,
`scenario` and `gains` are files, the rest are what each node's own parameters are called. One of
the files' words alone, or `strategy`, is the name of another file or strategy.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput, unknown
from lta_config.files import checked, find, load_yaml
from lta_config.override import held as held_at
from lta_config.override import override, quantity_in, shown
from lta_config.quantity import UNITS
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.settings import Settings
from lta_config.topics import topic_table
from lta_control.cascade import CascadeGains
from lta_control.estimator import EstimatorSettings
from lta_control.laws import law
from lta_control.laws.aboard import CASCADE
from lta_control.mission import MissionSettings
from lta_control.obedience import check_reserve
from lta_control.reserve import ReserveSettings
from lta_control.strategies import check_route, strategy
from lta_energy.monitoring.monitor import MonitorSettings
from lta_flight.listening import check_listening
from lta_flight.loop import Loop
from lta_flight.policy import Policy
from lta_model.scenario import beside, Scenario
from lta_model.vehicle import Vehicle
from lta_sim import in_scene
from lta_sim.world import World
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import Demodulation
from pydantic import BaseModel
import yaml

FILES = ('vehicle', 'scenario', 'gains')
SETTINGS: dict[str, type[Settings]] = {
    'gains': CascadeGains,
    'mission': MissionSettings,
    'reserve': ReserveSettings,
    'estimator': EstimatorSettings,
    'demodulator': Demodulation,
    'prior': LampPrior,
    'energy_monitor': MonitorSettings,
}
GAINS = 'gtmab'  # of a vehicle that names none
NAMED = ('strategy', *FILES)  # paths of one word: what they name is replaced as a whole
ROOTS = (*FILES, *(name for name in SETTINGS if name not in FILES))


@final
@dataclass(frozen=True, slots=True)
class Ingredients:
    """
    Everything that decides a flight but its seed.

    Attributes
    ----------
    names : mapping
        The files as they were named, by root.
    strategy : str
        Navigation strategy.
    contents : mapping
        What each file or node's settings hold, by root, as YAML has it.
    replaced : mapping
        Parameters that have been replaced, by path.

    """

    names: Mapping[str, str]
    strategy: str
    contents: Mapping[str, Any]
    replaced: Mapping[str, Any] = field(default_factory=dict)

    def with_values(self, values: Mapping[str, Any]) -> 'Ingredients':
        """
        Return these with parameters replaced, by path; `BadInput` where that cannot be.

        Where a file is replaced, what had been replaced in the one before is replaced in it.
        """
        other = {path: value for path, value in values.items() if path in NAMED}
        if other:
            rest = {path: value for path, value in values.items() if path not in NAMED}
            return self._of_others(other).with_values({**self.replaced, **rest})
        contents = dict(self.contents)
        for path, value in values.items():
            root, below = split(path)
            contents[root] = override(contents[root], below, value, root)
        return replace(self, contents=contents, replaced={**self.replaced, **values})

    def _of_others(self, names: Mapping[str, Any]) -> 'Ingredients':
        """Return these as they are read, made of other files or another strategy."""
        for path, name in names.items():
            if not isinstance(name, str):
                raise BadInput(f'{path} is {shown(name)}, but must be a name or a file.')
        own = {} if 'vehicle' not in names else {'gains': ''}  # another vehicle, its own gains
        named = {'strategy': self.strategy, **self.names, **own, **names}
        return gather(named['vehicle'], named['scenario'], named['strategy'], named['gains'])

    def held(self, path: str) -> Any:  # noqa: ANN401 - what YAML holds
        """Return what stands at a path; None for an effect's parameter that no file names."""
        if path in NAMED:
            return {'strategy': self.strategy, **self.names}[path]
        root, below = split(path)
        return held_at(self.contents[root], below, root)

    def unit(self, path: str) -> str:
        """Return the SI unit of a parameter; '' where it has none."""
        found = quantity_in(self.held(path))
        if found is not None:
            return UNITS.get(found['unit'], (found['unit'],))[0]
        if path in NAMED:
            return ''
        root, below = split(path)
        models = settings_of(self.contents['vehicle'])
        return declared_unit(models[root], below.split('.')) if root in models else ''


def split(path: str) -> tuple[str, str]:
    """Return the root of a path and the rest."""
    root, _, below = path.partition('.')
    if root not in ROOTS or not below:
        raise unknown('parameter', path, [*NAMED, *(f'{name}. ...' for name in ROOTS)])
    return root, below


def declared_unit(model: type[BaseModel], keys: list[str]) -> str:
    """Return the unit that a setting is declared with."""
    found = model.model_fields.get(keys[0])
    if found is None:
        return ''
    if len(keys) > 1:
        inner = found.annotation
        is_model = isinstance(inner, type) and issubclass(inner, BaseModel)
        return declared_unit(inner, keys[1:]) if is_model else ''  # type: ignore[arg-type]
    extra = found.json_schema_extra
    return str(extra.get('unit', '')) if isinstance(extra, dict) else ''


def gather(vehicle: str, scenario: str, strategy_name: str, gains: str) -> Ingredients:
    """
    Read what a flight is made of.

    Parameters
    ----------
    vehicle, scenario, gains : str
        Shipped names or paths; without gains, those that the vehicle's file names.
    strategy_name : str
        Navigation strategy.

    Raises
    ------
    BadInput
        If a file cannot be read or a name is not known.

    """
    strategy(strategy_name)
    own = control_in(load_yaml(find('vehicle', vehicle)))
    names = {'vehicle': vehicle, 'scenario': scenario, 'gains': gains or own.get('gains', GAINS)}
    contents = {root: load_yaml(find(root, name)) for root, name in names.items()}
    contents['scenario'] = beside(contents['scenario'], find('scenario', scenario).parent)
    contents['gains'] = gains_in(contents['gains'], names['gains'])
    for root, model in SETTINGS.items():
        contents.setdefault(root, model().model_dump() if root != 'gains' else None)
    return Ingredients(names, strategy_name, contents)


def control_in(content: Any) -> dict[str, str]:  # noqa: ANN401 - what YAML holds
    """Return law and gains as a vehicle's file names them, as far as they are words."""
    control = content.get('control') if isinstance(content, dict) else None
    given = control if isinstance(control, dict) else {}
    return {key: word for key, word in given.items() if isinstance(word, str)}


def settings_of(vehicle: Any) -> dict[str, type[Settings]]:  # noqa: ANN401 - what YAML holds
    """Return the kinds of settings, the gains those of the law that flies the vehicle."""
    return SETTINGS | {'gains': law(control_in(vehicle).get('law', CASCADE)).gains}


def gains_in(content: Any, name: str) -> Any:  # noqa: ANN401 - what YAML holds
    """Return the gains in a ROS parameter file."""
    try:
        return content['/**/controller']['ros__parameters']['gains']
    except (KeyError, TypeError):
        raise BadInput(
            f'{find("gains", name)} has no gains under /**/controller, ros__parameters; compare '
            'it with a shipped file.'
        ) from None


def parts_of(made_of: Ingredients) -> tuple[Vehicle, Scenario, Policy]:
    """
    Return vehicle, scene and what the drone decides by.

    Raises
    ------
    BadInput
        If something of it cannot be: one sentence.

    """
    scenario = _checked(Scenario, made_of, 'scenario')
    vehicle_file = _checked(VehicleFile, made_of, 'vehicle')
    models = settings_of(made_of.contents['vehicle'])
    gains, mission, reserve, estimator, demodulation, prior, energy = (
        _checked(model, made_of, root) for root, model in models.items()
    )
    policy = Policy(
        strategy=strategy(made_of.strategy),
        gains=gains,
        mission=mission,
        estimator=estimator,
        demodulation=demodulation,
        prior=prior,
        energy=energy,
        reserve=reserve,
        law=law(vehicle_file.control.law if vehicle_file.control else CASCADE),
    )
    check_route(policy.strategy, len(scenario.route))
    check_listening(scenario, policy.demodulation)
    check_reserve(policy.reserve, policy.strategy)
    vehicle = Vehicle(vehicle_file, scenario.air.density)
    _ = vehicle.hover_duty
    in_scene.check(vehicle, scenario)
    return vehicle, scenario, policy


def loop_of(made_of: Ingredients, seed: int) -> Loop:
    """Return a flight that is about to begin; `BadInput` if something of it cannot be."""
    vehicle, scenario, policy = parts_of(made_of)
    table = topic_table()
    world = World(vehicle, scenario, table, seed, made_of.strategy)
    return Loop(world, table, policy)


def _checked(model: type[Any], made_of: Ingredients, root: str) -> Any:  # noqa: ANN401 - a model
    """Return one part, checked; the sentence names the file, and what was replaced in it."""
    where = str(find(root, made_of.names[root])) if root in FILES else f'the settings of {root}'
    replaced = [path for path in made_of.replaced if path.startswith(f'{root}.')]
    if replaced:
        where += f' with {", ".join(replaced)} set'
    return checked(model, made_of.contents[root], where)


def write_files(made_of: Ingredients, folder: Path) -> dict[str, str]:
    """Write the files in which something was replaced; return all files' names by root."""
    names = dict(made_of.names)
    for root in FILES:
        if any(path.startswith(f'{root}.') for path in made_of.replaced):
            content = made_of.contents[root]
            if root == 'gains':
                content = {'/**/controller': {'ros__parameters': {'gains': content}}}
            path = folder / f'{root}.yaml'
            path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
            names[root] = str(path)
    return names


def spoken(values: Mapping[str, Any]) -> Iterable[str]:
    """Return replaced parameters as `lta simulate --set` takes them."""
    for path, value in values.items():
        found = quantity_in(value)
        yield f'{path}={value}' if found is None else f'{path}={text_of(found)}'


def text_of(found: Mapping[str, Any]) -> str:
    """Return a quantity as text that is read back to the last bit."""
    number = found['value']
    if isinstance(number, list | tuple):
        return f'{list(number)} {found["unit"]}'
    return f'{number!r} {found["unit"]}'
