# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Registry of the control laws, and the one that a drone flies by its own sensors."""

from typing import Any, TypeVar

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file, format_error, load_yaml
from lta_config.settings import Settings
from lta_control.laws import (
    cascade,
    glide,
    lateral,
    omnidirectional,
    open_loop,
    quadrotor,
    velocity,
)
from lta_control.laws.cascade import CascadeGains
from lta_control.laws.protocol import ControlLaw
from lta_model.vehicle import Vehicle
from pydantic import ValidationError

Gains = TypeVar('Gains', bound=Settings)

LAWS: dict[str, ControlLaw] = {
    'cascade': cascade.CASCADE_LAW,
    'glide': glide.GLIDE_LAW,
    'lateral': lateral.LATERAL_LAW,
    'omnidirectional': omnidirectional.OMNIDIRECTIONAL_LAW,
    'open_loop': open_loop.OPEN_LOOP_LAW,
    'quadrotor': quadrotor.QUADROTOR_LAW,
    'velocity': velocity.VELOCITY_LAW,
}


def find_control_law(name: str) -> ControlLaw:
    """Return a control law by name; raise `BadInput` with the known names for an unknown one."""
    if name not in LAWS:
        raise unknown_name_error('control law', name, list(LAWS))
    return LAWS[name]


CASCADE = 'cascade'


def vehicle_law_name(vehicle: Vehicle) -> str:
    """Return the law in the vehicle's file; the cascade if there is none."""
    return vehicle.file.control.law if vehicle.file.control else CASCADE


def check_onboard_law(vehicle: Vehicle) -> None:
    """Raise `BadInput` if the law of a vehicle cannot run on onboard sensors."""
    if (name := vehicle_law_name(vehicle)) != CASCADE:
        load_onboard_law(name, vehicle)


def load_onboard_law(
    name: str, vehicle: Vehicle, gains: CascadeGains | None = None
) -> tuple[ControlLaw, Any]:
    """
    Return a control law and its constants for a vehicle.

    An empty `name` stands for the law in the vehicle's file. `gains` are those of the cascade;
    other laws fly by those of that file. Raise `BadInput` if there is no such law, it needs a
    tracker, or it cannot fly the vehicle.
    """
    name = name or vehicle_law_name(vehicle)
    law = find_control_law(name)
    if law.is_tracked:
        raise BadInput(
            f'{vehicle.file.name} uses the control law {name}, which needs a position '
            'tracker, but the controller has only onboard sensors; fly the vehicle '
            'with "lta simulate", or choose another control law.'
        )
    if name == CASCADE and gains is not None:
        return law, law.build_constants(gains, vehicle)
    control = vehicle.file.control
    if control is None or control.gains is None:
        raise BadInput(
            f'{vehicle.file.name} names no gains for the control law {name}; add '
            '"gains: NAME" to the control block of the vehicle file.'
        )
    return law, law.build_constants(load_law_gains(law.gains, control.gains), vehicle)


def load_gains(name: str) -> CascadeGains:
    """Load the gains of the cascade, see `load_law_gains`."""
    return load_law_gains(CascadeGains, name)


def load_law_gains(kind: type[Gains], name: str) -> Gains:
    """
    Load the gains of a shipped vehicle or of a parameter file.

    `kind`: gains class of the control law. `name`: a shipped name or a path. Raise `BadInput` if
    there is no such file, or it holds no valid gains for a controller.
    """
    path = find_file('gains', name)
    content = load_yaml(path)
    try:
        # The file has the layout of a ROS parameter file for the controller node
        return kind.model_validate(content['/**/controller']['ros__parameters']['gains'])
    except ValidationError as error:
        raise BadInput(f'{path}: {format_error(error)}') from None
    except (KeyError, TypeError):
        raise BadInput(
            f'{path} has no gains under /**/controller, ros__parameters, gains; compare it '
            'with a file in config/control.'
        ) from None
