# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
List the quantities of a vehicle file that changed, with their places and sources.

Quantities that have a block of their own (drag, added mass) are changed there; the other effects
are switched on. Each source states the interval, the flights, and the value before.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_config.files import parse_yaml
from lta_config.parameter_override import get_parameter
from lta_config.vehicle_edit import set_yaml_values
from lta_discovery.model.nominal import NominalVehicle
from lta_model.effect_parameters import parts_drag
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle

SAME: Final = 1e-12  # relative; closer values count as unchanged
# Effects that derive from other blocks: where their numbers are, and in which order.
DERIVED_EFFECT_BLOCKS: Final[dict[str, tuple[tuple[str, tuple[str, ...]], ...]]] = {
    'linear_drag': (('aero.linear_drag.force', AXES[:3]),),
    'quadratic_drag': (('aero.quadratic_drag.force', AXES[:3]),),
    'rotational_drag': (
        ('aero.linear_drag.moment', AXES[3:]),
        ('aero.quadratic_drag.moment', tuple(f'{axis}_2' for axis in AXES[3:])),
    ),
    'added_mass': (('hull.added_mass.mass', AXES[:3]),),
    'added_inertia': (('hull.added_mass.inertia', AXES[3:]),),
    'moving_mass': (('moving_mass.mass', ('mass',)), ('moving_mass.position', ('x', 'y', 'z'))),
}
PAIRED_EFFECTS: Final = ('added_mass', 'added_inertia')  # a hull states both or none
# Follows from the drag of the aero block, as far as it is not about the shape of the hull.
FOLLOWS: Final = {'cross_flow': AXES[:3]}


@final
@dataclass(frozen=True, slots=True)
class VehicleFileQuantity:
    """A quantity and its place in the file."""

    place: str
    value: float | list[float]
    unit: str
    source: str

    @property
    def as_yaml(self) -> dict[str, Any]:
        """Content of its YAML node."""
        return {'value': self.value, 'unit': self.unit, 'source': self.source}


def list_changed_quantities(
    text: str,
    vehicle: Vehicle,
    nominal: NominalVehicle,
    learned: NominalVehicle,
    notes: Mapping[tuple[str, str], str],
    source: str,
) -> Iterator[VehicleFileQuantity]:
    """Yield the changed quantities of a file, with a note for each parameter in `notes`."""
    content = parse_yaml(text, vehicle.file.name)
    moved = _find_changed_parameters(nominal.effect_parameters, learned.effect_parameters)
    if set(moved) & set(PAIRED_EFFECTS):
        # Both blocks have to be written if one changes
        moved = {**dict.fromkeys(PAIRED_EFFECTS, ()), **moved}
    for effect, names in moved.items():
        own_notes = {name: notes[effect, name] for name in names if (effect, name) in notes}
        if effect in DERIVED_EFFECT_BLOCKS:
            yield from _list_block_quantities(
                content, vehicle, learned, effect, names, own_notes, source
            )
        else:
            units = {one.name: one.unit for one in EFFECTS[effect].parameters}
            for name in names:
                if name in FOLLOWS.get(effect, ()):
                    continue
                place = f'effects.{effect}.{name}'
                words = _format_provenance(
                    source, [own_notes[name]] if name in own_notes else [], content, place
                )
                yield VehicleFileQuantity(
                    place, learned.parameter_value(effect, name), units[name], words
                )


def _find_changed_parameters(
    before: Mapping[str, Mapping[str, float]], after: Mapping[str, Mapping[str, float]]
) -> dict[str, Sequence[str]]:
    """Return the new or changed parameters, by effect."""
    out: dict[str, Sequence[str]] = {}
    for effect, values in after.items():
        old = before.get(effect, {})
        names = [
            name
            for name, value in values.items()
            if name not in old or not math.isclose(value, old[name], rel_tol=SAME, abs_tol=0.0)
        ]
        if names:
            out[effect] = names
    return out


def _list_block_quantities(
    content: Any,
    vehicle: Vehicle,
    learned: NominalVehicle,
    effect: str,
    names: Sequence[str],
    notes: Mapping[str, str],
    source: str,
) -> Iterator[VehicleFileQuantity]:
    """Yield the quantities of an effect that derives from a block."""
    units = {one.name: one.unit for one in EFFECTS[effect].parameters}
    for place, order in DERIVED_EFFECT_BLOCKS[effect]:
        if not set(order) & set(names) and effect not in PAIRED_EFFECTS:
            continue
        numbers = [learned.parameter_value(effect, name) for name in order]
        if effect == 'quadratic_drag':
            # The model sums the drag of aero block and parts; the file holds the aero block alone.
            faces = parts_drag(vehicle.file, vehicle.air_density)
            numbers = [all_ - own for all_, own in zip(numbers, faces, strict=True)]
            if min(numbers) < 0.0:
                raise BadInput(
                    f'The learned quadratic drag is smaller than the drag of the parts of '
                    f'{vehicle.file.name} alone. If its aero block includes their drag, set '
                    'in_aero: true in the drag of each part, and run lta discover again.'
                )
        words = [f'{name} {notes[name]}' for name in order if name in notes]
        if not set(order) & set(names):
            yield VehicleFileQuantity(place, numbers, units[order[0]], 'unchanged by lta discover')
        else:
            held = numbers if len(order) > 1 else numbers[0]
            yield VehicleFileQuantity(
                place, held, units[order[0]], _format_provenance(source, words, content, place)
            )


def _format_provenance(source: str, notes: Sequence[str], content: Any, place: str) -> str:
    """Return the source of a number: note, flights, and the value before."""
    try:
        before = get_parameter(content, place, 'vehicle')
    except BadInput:
        before = None
    was = before.get('source') if isinstance(before, dict) else None
    number = before.get('value') if isinstance(before, dict) else None
    old = (
        '' if number is None else f'; previously {number} {before["unit"]} ({was or "no source"})'
    )
    return '; '.join([*notes, source]) + old


def format_hypothesis(text: str, vehicle: Vehicle, nominal: NominalVehicle) -> str:
    """
    Return the text of a vehicle file with hypothetical effects.

    Raise `BadInput` if the format has no place for a parameter, or the vehicle is impossible.
    """
    changed = list_changed_quantities(
        text, vehicle, NominalVehicle.from_vehicle(vehicle), nominal, {}, 'supposed'
    )
    return set_yaml_values(text, {one.place: one.as_yaml for one in changed})
