"""The gains of a vehicle, from the ROS parameter file that its controller gets."""

from lta_config.errors import BadInput
from lta_config.files import find, load_yaml
from lta_config.sentence import sentence
from lta_control.cascade import CascadeGains
from pydantic import ValidationError


def load_gains(name: str) -> CascadeGains:
    """
    Return the gains of a shipped vehicle or of a parameter file.

    Raises
    ------
    BadInput
        If there is no such file, or it holds no valid gains for a controller.

    """
    path = find('gains', name)
    content = load_yaml(path)
    try:
        return CascadeGains.model_validate(content['/**/controller']['ros__parameters']['gains'])
    except ValidationError as error:
        raise BadInput(f'{path}: {sentence(error)}') from None
    except (KeyError, TypeError):
        raise BadInput(
            f'{path} has no gains under /**/controller, ros__parameters; compare it with a '
            'shipped file.'
        ) from None
