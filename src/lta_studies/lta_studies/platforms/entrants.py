"""Build and check the entrants of a comparison file."""

from collections.abc import Mapping
from typing import Any

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file, load_yaml, validate_content
from lta_config.parameter_override import parse_value, replace_parameter
from lta_config.schema.comparison_file import Contestant, EntryChange
from lta_config.schema.vehicle_file import load_vehicle_content, VehicleFile
from lta_control.gains_file import load_law_gains
from lta_control.laws import find_control_law
from lta_model.vehicle import Vehicle
from lta_studies.platforms.flight import Entrant

ROOTS = ('vehicle', 'gains')


def build_entrant(
    contestant: Contestant, air_density: float, change: EntryChange | None = None
) -> Entrant:
    """
    Build a contestant, optionally with an ablation or a limit applied.

    `contestant`: entry of the comparison file. `air_density`: air density of the scenario [kg/m3].
    `change`: ablation or limit of the contestant. Raise `BadInput` if it cannot be built, or its
    control law cannot fly it.
    """
    # An ablation builds on the changes of its contestant, in this order.
    steps: list[EntryChange] = [contestant] if change is None else [contestant, change]
    content = load_vehicle_content(find_file('vehicle', contestant.vehicle))
    for step in steps:
        content = _apply_changes(_borrow_blocks(content, step), step.changes, 'vehicle')
    where = f'{find_file("vehicle", contestant.vehicle)} with the changes of the comparison'
    file = validate_content(VehicleFile, content, where)
    named = _select_law(file, steps)
    gains = load_law_gains(find_control_law(named[0]).gains, named[1])
    values = gains.model_dump()
    for step in steps:
        values = _apply_changes(values, step.changes, 'gains')
    gains = validate_content(
        type(gains), values, f'{find_file("gains", named[1])} with the changes of the comparison'
    )
    vehicle = Vehicle(file, air_density)
    law = find_control_law(named[0])
    law.build_constants(gains, vehicle)  # raises if the law cannot fly the vehicle
    release = contestant.release.si if contestant.release else None
    return Entrant(vehicle, law, gains, release)


def _select_law(file: VehicleFile, steps: list[EntryChange]) -> tuple[str, str]:
    """Return law and gains: the last ones named, else those of the vehicle."""
    name = file.control.law if file.control else 'cascade'
    gains = file.control.gains if file.control else None
    for step in steps:
        name, gains = step.law or name, step.gains or gains
    if gains is None:
        raise BadInput(
            f'{file.name} names no gains in its control block; add a line "gains: NAME".'
        )
    return name, gains


def _borrow_blocks(content: Any, step: EntryChange) -> Any:  # noqa: ANN401 - what YAML holds
    if step.borrow is None:
        return content
    other = load_yaml(find_file('vehicle', step.borrow.vehicle))
    return {**content, **{block: other[block] for block in step.borrow.blocks}}


def _apply_changes(content: Any, changes: Mapping[str, Any], root: str) -> Any:  # noqa: ANN401
    """Apply the changes under `root` to the content of a file."""
    for path, value in changes.items():
        begin, _, below = path.partition('.')
        # Checked for every path, also one that belongs to the other root.
        if begin not in ROOTS or not below:
            raise unknown_name_error('parameter', path, [f'{name}. ...' for name in ROOTS])
        if begin == root:
            content = replace_parameter(content, below, parse_value(value, path), root)
    return content
