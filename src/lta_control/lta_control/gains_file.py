# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Load the gains of a vehicle from its controller's ROS parameter file."""

from typing import TypeVar

from lta_config.errors import BadInput
from lta_config.files import find_file, format_error, load_yaml
from lta_config.settings import Settings
from lta_control.cascade import CascadeGains
from pydantic import ValidationError

Gains = TypeVar('Gains', bound=Settings)


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
