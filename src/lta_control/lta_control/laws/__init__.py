"""Control laws by name."""

from lta_config.errors import unknown
from lta_control.laws import (
    cascade,
    glide,
    lateral,
    omnidirectional,
    open_loop,
    quadrotor,
    velocity,
)
from lta_control.laws.protocol import Law

LAWS: dict[str, Law] = {
    'cascade': cascade.LAW,
    'glide': glide.LAW,
    'lateral': lateral.LAW,
    'omnidirectional': omnidirectional.LAW,
    'open_loop': open_loop.LAW,
    'quadrotor': quadrotor.LAW,
    'velocity': velocity.LAW,
}


def law(name: str) -> Law:
    """Return a control law; an unknown name is a `BadInput` that lists the known ones."""
    if name not in LAWS:
        raise unknown('control law', name, list(LAWS))
    return LAWS[name]
