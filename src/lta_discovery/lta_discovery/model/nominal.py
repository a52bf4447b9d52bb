# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Represent a vehicle by the inputs of the model, so that single parameters can be changed."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final, Self

from lta_discovery.model.replay_kernel import (
    ACTUATOR_LAYOUT,
    ACTUATOR_PLACES,
    BODY_LAYOUT,
    BODY_PLACES,
    LATENT,
)
from lta_model.effects import EFFECTS, initial_memory
from lta_model.effects.protocol import BodyEffect, Effect, InertiaEffect, MeasurementEffect
from lta_model.measurement_chain import build_chains, Chain
from lta_model.model import fill_parameters, VehicleModel
from lta_model.state import RIGID
from lta_model.vehicle import Vehicle
from lta_sim.kernels.layout import EffectLayout
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.uint8]
Given = Mapping[str, Mapping[str, float]]


@final
@dataclass(frozen=True, slots=True)
class ReplayRows:
    """
    Inputs of the compiled replay for one set of parameters.

    Attributes
    ----------
    actuators, body : ndarray of float64
        Row of each kernel, complete but for command, surroundings and motion.
    actuators_on, body_on : ndarray of uint8
        Flags of the active effects.
    acting : mapping of str to Chain
        Measurement effects by channel.

    """

    actuators: Array
    actuators_on: Flags
    body: Array
    body_on: Flags
    acting: Mapping[str, Chain]


@final
@dataclass(frozen=True, slots=True, eq=False)
class NominalVehicle:
    """Inputs of `VehicleModel.build`."""

    effect_parameters: Given  # parameters by effect and name
    # Of the vehicle and of the displaced air [kg]
    mass: float
    displaced: float
    cg: Array  # from the hull centre, shape (3,) [m]
    inertia: Array  # about the centre of gravity, shape (3, 3) [kg m2]
    rotors: tuple[tuple[Array, Array], ...]  # as in `VehicleModel.build`

    @classmethod
    def from_vehicle(cls, vehicle: Vehicle) -> Self:
        """Return a vehicle's numbers."""
        return cls(
            vehicle.collect_effects(),
            vehicle.mass,
            vehicle.displaced_mass,
            np.asarray(vehicle.cg, dtype=np.float64),
            np.asarray(vehicle.inertia, dtype=np.float64),
            tuple((np.array(rotor.place), np.array(rotor.axis)) for rotor in vehicle.rotors),
        )

    def parameter_value(self, effect: str, parameter: str) -> float:
        """Return a parameter of an effect; its null value where the vehicle does not set it."""
        null = {declaration.name: declaration.null for declaration in EFFECTS[effect].parameters}[
            parameter
        ]
        return float(self.effect_parameters.get(effect, {}).get(parameter, null))

    def with_value(self, effect: str, parameter: str, value: float) -> 'NominalVehicle':
        """Return the vehicle with one parameter of an effect replaced."""
        own = {**self.effect_parameters.get(effect, {}), parameter: value}
        return replace(self, effect_parameters={**self.effect_parameters, effect: own})

    def with_mass_at(self, place: Array) -> 'NominalVehicle':
        """
        Return the vehicle with its moving mass at a place, with updated CG and inertia.

        The effect itself moves only the weight, not the CG. In a slow spiral, the yaw moment of a
        CG 1 cm off is as large as that of the hull.
        """
        own = self.effect_parameters.get('moving_mass', {})
        mass = own.get('mass', 0.0)
        # No moving mass, nothing to update
        if mass == 0.0:
            return self
        rest = np.array([own.get(axis, 0.0) for axis in 'xyz'])
        cg = self.cg + mass / self.mass * (place - rest)
        # Parallel-axis theorem: to the hull centre, move the mass, and back to the new CG.
        about_hull = self.inertia + self.mass * _point_inertia(self.cg)
        inertia = (
            about_hull
            + mass * (_point_inertia(place) - _point_inertia(rest))
            - self.mass * _point_inertia(cg)
        )
        there = {**own, **dict(zip('xyz', map(float, place), strict=True))}
        return replace(
            self,
            cg=cg,
            inertia=inertia,
            effect_parameters={**self.effect_parameters, 'moving_mass': there},
        )

    def build_model(self) -> VehicleModel:
        """Return the kernel's model; raise `BadInput` for an impossible vehicle."""
        return VehicleModel.build(
            self.effect_parameters,
            mass=self.mass,
            cg=self.cg,
            inertia=self.inertia,
            displaced=self.displaced,
            rotors=self.rotors,
        )

    def build_replay_rows(self) -> ReplayRows:
        """Return the inputs of the compiled replay; errors as in `build_model`."""
        model = self.build_model()
        actuators = np.zeros(max(part.stop for part in ACTUATOR_PLACES.values()))
        body = np.zeros(max(part.stop for part in BODY_PLACES.values()))
        for row, where in ((actuators, ACTUATOR_PLACES), (body, BODY_PLACES)):
            # Body constants and inverse mass matrix, the same in both kernels
            row[where['body']], row[where['inverse']] = model.body, model.inverse
        a_on = _copy_model(model, actuators, ACTUATOR_PLACES, ACTUATOR_LAYOUT)
        b_on = _copy_model(model, body, BODY_PLACES, BODY_LAYOUT)
        acting = build_chains(model.effect_parameters, EFFECTS)
        return ReplayRows(actuators, a_on, body, b_on, acting)

    def update_replay_rows(self, other: 'NominalVehicle', rows: ReplayRows) -> ReplayRows:
        """
        Return what `build_replay_rows` returns, reusing the rows of a similar vehicle.

        `other`: the vehicle that this one was derived from. Raise `BadInput` as in `build_model`.
        """
        # Identity suffices: `with_value` builds a new mapping for a changed effect only
        changed = [
            name
            for name in self.effect_parameters
            if self.effect_parameters[name] is not other.effect_parameters.get(name)
        ]
        # Mass properties and body effects enter the mass matrix, which needs a full rebuild.
        weighed = (
            not set(other.effect_parameters) <= set(self.effect_parameters)
            or self.mass != other.mass
            or self.displaced != other.displaced
            or any(
                mine is not its
                for mine, its in (
                    (self.cg, other.cg),
                    (self.inertia, other.inertia),
                    (self.rotors, other.rotors),
                )
            )
        )
        kinds = [EFFECTS[name] for name in changed]
        if weighed or any(isinstance(kind, InertiaEffect | BodyEffect) for kind in kinds):
            return self.build_replay_rows()
        acting = rows.acting
        if any(isinstance(kind, MeasurementEffect) for kind in kinds):
            acting = build_chains(self.effect_parameters, EFFECTS)
        new = ReplayRows(
            rows.actuators.copy(),
            rows.actuators_on.copy(),
            rows.body.copy(),
            rows.body_on.copy(),
            acting,
        )
        for kind in kinds:
            numbers = fill_parameters(kind, self.effect_parameters[kind.name])
            _write_effect(
                new.actuators, new.actuators_on, ACTUATOR_PLACES, ACTUATOR_LAYOUT, kind, numbers
            )
            _write_effect(new.body, new.body_on, BODY_PLACES, BODY_LAYOUT, kind, numbers)
        return new


def _point_inertia(place: Array) -> Array:
    """Return the inertia of a unit mass at a place, about the hull centre."""
    tensor: Array = place @ place * np.eye(3) - np.outer(place, place)
    return tensor


def _write_effect(
    row: Array,
    on: Flags,
    where: Mapping[str, slice],
    layout: EffectLayout,
    effect: Effect,
    values: Mapping[str, float],
) -> None:
    """Write the parameters of an effect into a row that has it, and its flag."""
    if effect.name in layout.effects:
        first = where['parameters'].start + layout.first[effect.name]
        row[first : first + len(values)] = list(values.values())
        # Skipping effects at their null values makes the replay faster
        active = any(values[parameter.name] != parameter.null for parameter in effect.parameters)
        on[layout.flag_index(effect.name)] = active


def _copy_model(
    model: VehicleModel, row: Array, where: Mapping[str, slice], layout: EffectLayout
) -> Flags:
    """Copy a model's parameters and initial memory into a row of some effects; return flags."""
    memory = initial_memory()
    on = np.ones(len(layout.effects), dtype=np.uint8)
    for flag, (name, effect) in enumerate(layout.effects.items()):
        # Exists only in the replay, not in the vehicle model
        if name == LATENT:
            continue
        count, size = len(effect.parameters), layout.memory_size(name)
        to, of = where['parameters'].start + layout.first[name], SIM_LAYOUT.first[name]
        row[to : to + count] = model.parameters[of : of + count]
        # The model's memory starts after the rigid-body state
        to, of = layout.remembers[name], SIM_LAYOUT.remembers[name] - RIGID
        row[to : to + size] = memory[of : of + size]
        on[flag] = model.on[SIM_LAYOUT.flag_index(name)]
    return on
