"""Move the start of a scenario, for several drones in one scene."""

from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_model.scenario import Scenario
from pydantic import ValidationError

FAR = 1000.0  # m; no scene is larger


def offset_start(scenario: Scenario, x: float, y: float) -> Scenario:
    """
    Return a scenario with the start moved; the same object for a zero offset.

    Raise `BadInput` if the drone would start outside of the room or within its goal.
    """
    if x == 0.0 and y == 0.0:
        return scenario
    if not (abs(x) <= FAR and abs(y) <= FAR):  # false for NaN too
        raise BadInput(
            f'The start offset is {x:g}, {y:g} m; give an offset_x and an offset_y from '
            f'{-FAR:g} to {FAR:g}.'
        )
    before = scenario.start.position.vector
    place = before[0] + x, before[1] + y
    start = scenario.start.model_copy(
        update={'position': Quantity(value=place, unit='m', source=scenario.start.position.source)}
    )
    # Validate anew: model_copy alone does not run the validators
    fields = {name: getattr(scenario, name) for name in Scenario.model_fields}
    for name, key in (('schema_version', 'schema'), ('alone', 'lamp'), ('several', 'lamps')):
        fields[key] = fields.pop(name)  # as the file has it
    try:
        return Scenario.model_validate({**fields, 'start': start})
    except ValidationError as error:
        # The scene without the offset was valid, so the only error is that of the start.
        fault = error.errors()[0]['msg'].removeprefix('Value error, ')
        fault = fault.partition(';')[0]  # the remedy after it is for the scenario file
        raise BadInput(
            f"With a start offset of {x:g}, {y:g} m the scenario '{scenario.name}' {fault}; "
            'give another offset_x or offset_y.'
        ) from None
