"""Registry of the control laws."""

from lta_config.errors import unknown_name_error
from lta_control.laws import (
    cascade,
    glide,
    lateral,
    omnidirectional,
    open_loop,
    quadrotor,
    velocity,
)
from lta_control.laws.protocol import ControlLaw

LAWS: dict[str, ControlLaw] = {
    'cascade': cascade.LAW,
    'glide': glide.LAW,
    'lateral': lateral.LAW,
    'omnidirectional': omnidirectional.LAW,
    'open_loop': open_loop.LAW,
    'quadrotor': quadrotor.LAW,
    'velocity': velocity.LAW,
}


def find_control_law(name: str) -> ControlLaw:
    """Return a control law by name; raise `BadInput` with the known names for an unknown one."""
    if name not in LAWS:
        raise unknown_name_error('control law', name, list(LAWS))
    return LAWS[name]
