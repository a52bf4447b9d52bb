# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
List the elements of a model: what a vehicle may have and its file does not.

An element is an effect of the library, a number of the file that is further off than its
tolerance, or a force of a form that the library does not have. It moves some columns of the linear
model together, each with a normal prior whose size is not known beforehand.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import final, Literal, NamedTuple

from lta_discovery.model.candidates import vector_components
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.settings import (
    EFFECT_SIZES,
    EXPECTED_EFFECTS,
    EXPECTED_FORCES,
    EXPECTED_NUMBERS,
    FORCE_SIZES,
    NUMBER_SIZES,
)
import numpy as np
from numpy.typing import NDArray

Kind = Literal['effect', 'number', 'force']


@final
@dataclass(frozen=True, slots=True)
class Element:
    """What may be present in a model."""

    name: str  # 'linear_drag.surge', 'vehicle.mass', 'heave by place'
    kind: Kind
    columns: tuple[int, ...]
    unit: tuple[float, ...]  # size 1 of each column, in the unit of its parameter
    sizes: tuple[float, ...]  # in these units; one of them, all alike, if the element is present
    log_prior: float  # of presence with one of the sizes


class ElementChoice(NamedTuple):
    """An element of a model, by its index, with its size."""

    element: int
    size: float


Model = frozenset[ElementChoice]
NO_ELEMENTS: Model = frozenset()


class ForceGroup(NamedTuple):
    """Terms of a force of another form, which are one element."""

    name: str
    terms: int


def list_elements(
    parameters: Sequence[FreeParameter], forces: Sequence[ForceGroup]
) -> list[Element]:
    """
    Return all elements.

    The columns are those of the parameters, followed by those of the forces. A parameter that a
    flight has of its own is no element.
    """
    effects, numbers = _list_effects(parameters), _list_numbers(parameters)
    return [*effects, *numbers, *_list_forces(forces, len(parameters))]


def compute_variance(
    elements: Sequence[Element], model: Model, tolerance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """
    Return the prior variance of each column in a model; 0 if it is absent.

    `tolerance`: standard deviation of each column whatever the model, shape (K,).
    """
    out: NDArray[np.float64] = tolerance**2
    for choice in model:
        one = elements[choice.element]
        out[list(one.columns)] += (choice.size * np.array(one.unit)) ** 2
    return out


def _list_effects(parameters: Sequence[FreeParameter]) -> list[Element]:
    """Return the effects: each as probable as the others, and shared by its parameters."""
    places = {one.name: k for k, one in enumerate(parameters) if _is_candidate(one)}
    groups = dict.fromkeys(
        tuple(part for part in vector_components(name) if part in places) or (name,)
        for name in places
    )
    effects = [group[0].partition('.')[0] for group in groups]
    shares = Counter(effects)
    return [
        Element(
            group[0],
            'effect',
            columns := tuple(places[part] for part in group),
            tuple(parameters[k].typical for k in columns),
            EFFECT_SIZES,
            math.log(EXPECTED_EFFECTS / len(shares) / shares[effect] / len(EFFECT_SIZES)),
        )
        for group, effect in zip(groups, effects, strict=True)
    ]


def _is_candidate(one: FreeParameter) -> bool:
    return one.typical > 0.0 and not one.per_flight


def _list_numbers(parameters: Sequence[FreeParameter]) -> list[Element]:
    """Return the numbers of the file that may be wrong, and are no effect."""
    places = [
        k
        for k, one in enumerate(parameters)
        if one.tolerance > 0.0 and not one.per_flight and not _is_candidate(one)
    ]
    if not places:
        return []
    prior = math.log(EXPECTED_NUMBERS / len(places) / len(NUMBER_SIZES))
    return [
        Element(
            parameters[k].name, 'number', (k,), (parameters[k].tolerance,), NUMBER_SIZES, prior
        )
        for k in places
    ]


def _list_forces(forces: Sequence[ForceGroup], first: int) -> list[Element]:
    """Return the forces of other forms, whose terms share their variance."""
    out = []
    for name, terms in forces:
        prior = math.log(EXPECTED_FORCES / len(forces) / len(FORCE_SIZES))
        columns = tuple(range(first, first + terms))
        out.append(Element(name, 'force', columns, (terms**-0.5,) * terms, FORCE_SIZES, prior))
        first += terms
    return out
