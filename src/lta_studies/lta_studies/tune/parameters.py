"""
List, bound and replace the tunable parameters of a settings object.

Works on any nested `Settings` whose fields declare bounds, so all control laws are tuned in the
same way. A parameter is searched on a logarithmic scale, within a factor of its start value and
within its declared bounds.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final, TypeVar

from lta_config.errors import BadInput, unknown_name_error
from pydantic import BaseModel
from pydantic.fields import FieldInfo

GAINS = ('kp', 'ki', 'kd', 'gain')  # how names of gains end; limits and angles are not gains
REACH = 6.0  # a search covers value / 6 to value * 6

Model = TypeVar('Model', bound=BaseModel)


@final
@dataclass(frozen=True, slots=True)
class TunableParameter:
    """One tunable parameter of a settings object."""

    path: str  # dotted path, for example `climb.kp`
    value: float  # current value
    # Declared bounds
    low: float
    high: float
    # Declared description and unit
    about: str = ''
    unit: str = ''

    def search_bounds(self, reach: float = REACH) -> tuple[float, float]:
        """Return the bounds of the search."""
        return max(self.low, self.value / reach), min(self.high, self.value * reach)


def iterate_parameters(settings: BaseModel, above: str = '') -> Iterator[TunableParameter]:
    """Yield every float of a settings object, depth first."""
    for name, field in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from iterate_parameters(value, f'{above}{name}.')
        # Integers and switches have no logarithmic scale, so they are not tuned.
        elif isinstance(value, float):
            extra = field.json_schema_extra
            unit = str(extra.get('unit', '')) if isinstance(extra, dict) else ''
            low, high = _declared_bounds(field)
            yield TunableParameter(
                f'{above}{name}', value, low, high, field.description or '', unit
            )


def _declared_bounds(field: FieldInfo) -> tuple[float, float]:
    """Return the declared closed bounds; infinite where none is declared."""
    low, high = -math.inf, math.inf
    # Pydantic stores bounds as annotated-types `Ge` and `Le`; other rules have neither name.
    for rule in field.metadata:
        low, high = getattr(rule, 'ge', low), getattr(rule, 'le', high)
    return low, high


def select_parameters(settings: BaseModel, names: Sequence[str] = ()) -> list[TunableParameter]:
    """
    Return the parameters to search.

    `settings`: start values. `names`: paths; by default all positive parameters whose names end
    like gains. Raise `BadInput` if a name is unknown, or a value is not positive and so has no
    logarithm.
    """
    by_path = {number.path: number for number in iterate_parameters(settings)}
    if not names:
        return [n for n in by_path.values() if n.value > 0.0 and n.path.endswith(GAINS)]
    for name in names:
        if name not in by_path:
            raise unknown_name_error('number', name, list(by_path))
        if not by_path[name].value > 0.0:
            raise BadInput(
                f'{name} starts at {by_path[name].value:g}, but the search multiplies it by '
                'factors and needs a value above 0; set one in the start gains.'
            )
    # Duplicates removed, order kept: the order defines the axes of the search.
    return [by_path[name] for name in dict.fromkeys(names)]


def replace_parameters(settings: Model, values: Mapping[str, float]) -> Model:
    """Return validated settings with some values replaced."""
    content = settings.model_dump()
    for path, value in values.items():
        *above, last = path.split('.')
        place = content
        for name in above:
            place = place[name]
        place[last] = float(value)
    # Validation also checks rules between fields, which single bounds cannot.
    return type(settings).model_validate(content)
