"""
The numbers of a settings object that a search may turn: names, bounds, and how to change them.

Works on any `Settings` whose fields say their bounds, nested as they are, so that every control
law is tuned alike. A number is searched on a logarithm, within a factor of where it starts and
within the bounds of its own declaration.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import final, TypeVar

from lta_config.errors import BadInput, unknown_name
from pydantic import BaseModel
from pydantic.fields import FieldInfo

GAINS = ('kp', 'ki', 'kd', 'gain')  # how names of gains end; limits and angles are not gains
REACH = 6.0  # factor either way

Model = TypeVar('Model', bound=BaseModel)


@final
@dataclass(frozen=True, slots=True)
class TunableParameter:
    """
    One number of a settings object.

    Attributes
    ----------
    path : str
        Where it stands, `climb.kp` for example.
    value : float
        What it is.
    low, high : float
        Bounds of its declaration.
    about, unit : str
        Its declaration.

    """

    path: str
    value: float
    low: float
    high: float
    about: str = ''
    unit: str = ''

    def search_bounds(self, reach: float = REACH) -> tuple[float, float]:
        """Return the ends of its search."""
        return max(self.low, self.value / reach), min(self.high, self.value * reach)


def iterate_parameters(settings: BaseModel, above: str = '') -> Iterator[TunableParameter]:
    """Yield every float of a settings object, depth first."""
    for name, field in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from iterate_parameters(value, f'{above}{name}.')
        elif isinstance(value, float):
            extra = field.json_schema_extra
            unit = str(extra.get('unit', '')) if isinstance(extra, dict) else ''
            low, high = _declared_bounds(field)
            yield TunableParameter(
                f'{above}{name}', value, low, high, field.description or '', unit
            )


def _declared_bounds(field: FieldInfo) -> tuple[float, float]:
    """Return the closed bounds of a declaration; infinite where it has none."""
    low, high = -math.inf, math.inf
    for rule in field.metadata:
        low, high = getattr(rule, 'ge', low), getattr(rule, 'le', high)
    return low, high


def select_parameters(settings: BaseModel, names: Sequence[str] = ()) -> list[TunableParameter]:
    """
    Return the numbers to search.

    Parameters
    ----------
    settings : BaseModel
        The start.
    names : sequence of str
        Their paths; by default all above zero whose names end as those of gains do.

    Raises
    ------
    BadInput
        If a name is not known, or a number is not above zero and so has no logarithm.

    """
    found = {number.path: number for number in iterate_parameters(settings)}
    if not names:
        return [n for n in found.values() if n.value > 0.0 and n.path.endswith(GAINS)]
    for name in names:
        if name not in found:
            raise unknown_name('number', name, list(found))
        if not found[name].value > 0.0:
            raise BadInput(
                f'{name} starts at {found[name].value:g}; start from a value above 0, the search '
                'turns it by factors.'
            )
    return [found[name] for name in dict.fromkeys(names)]


def replace_parameters(settings: Model, values: Mapping[str, float]) -> Model:
    """Return settings with numbers replaced, checked as a file's would be."""
    content = settings.model_dump()
    for path, value in values.items():
        *above, last = path.split('.')
        place = content
        for name in above:
            place = place[name]
        place[last] = float(value)
    return type(settings).model_validate(content)
