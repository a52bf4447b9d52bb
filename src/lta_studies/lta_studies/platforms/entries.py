"""Make the entrants of a comparison from its file, every one checked before any of them flies."""

from collections.abc import Mapping
from typing import Any

from lta_config.errors import BadInput, unknown
from lta_config.files import checked, find, load_yaml
from lta_config.override import override, value_of
from lta_config.schema.comparison_file import Change, Contestant
from lta_config.schema.vehicle_file import VehicleFile
from lta_control.gains_file import load_gains_of
from lta_control.laws import law
from lta_model.vehicle import Vehicle
from lta_studies.platforms.flying import Entrant

ROOTS = ('vehicle', 'gains')


def entrant(contestant: Contestant, air_density: float, change: Change | None = None) -> Entrant:
    """
    Return a contestant, with one more change if there is one, ready to fly.

    Parameters
    ----------
    contestant : Contestant
        Who flies.
    air_density : float
        Of the scenario. [kg/m3]
    change : Change or None
        An ablation or a limit of it.

    Raises
    ------
    BadInput
        If it cannot be built or flown by its law.

    """
    steps: list[Change] = [contestant] if change is None else [contestant, change]
    content = load_yaml(find('vehicle', contestant.vehicle))
    for step in steps:
        content = _changed(_borrowed(content, step), step.changes, 'vehicle')
    where = f'{find("vehicle", contestant.vehicle)}, as the comparison changes it'
    file = checked(VehicleFile, content, where)
    named = _law_of(file, steps)
    gains = load_gains_of(law(named[0]).gains, named[1])
    values = gains.model_dump()
    for step in steps:
        values = _changed(values, step.changes, 'gains')
    gains = checked(
        type(gains), values, f'{find("gains", named[1])}, as the comparison changes it'
    )
    vehicle = Vehicle(file, air_density)
    made = law(named[0])
    made.known(gains, vehicle)  # refuses a vehicle that the law cannot fly
    release = contestant.release.si if contestant.release else None
    return Entrant(vehicle, made, gains, release)


def _law_of(file: VehicleFile, steps: list[Change]) -> tuple[str, str]:
    """Return law and gains: the last that is named, else the vehicle's own."""
    name = file.control.law if file.control else 'cascade'
    gains = file.control.gains if file.control else None
    for step in steps:
        name, gains = step.law or name, step.gains or gains
    if gains is None:
        raise BadInput(f'{file.name} names no gains in its control block; add "gains: ...".')
    return name, gains


def _borrowed(content: Any, step: Change) -> Any:  # noqa: ANN401 - what YAML holds
    if step.borrow is None:
        return content
    other = load_yaml(find('vehicle', step.borrow.vehicle))
    return {**content, **{block: other[block] for block in step.borrow.blocks}}


def _changed(content: Any, changes: Mapping[str, Any], root: str) -> Any:  # noqa: ANN401
    """Return what a file holds with those of the changes that are its own."""
    for path, value in changes.items():
        begin, _, below = path.partition('.')
        if begin not in ROOTS or not below:
            raise unknown('parameter', path, [f'{name}. ...' for name in ROOTS])
        if begin == root:
            content = override(content, below, value_of(value, path), root)
    return content
