"""Summarise an effect in one sentence, from its own file."""

import inspect
import sys

from lta_model.effects.protocol import (
    ActuatorEffect,
    AirEffect,
    BodyEffect,
    Effect,
    InertiaEffect,
    MeasurementEffect,
    WrenchEffect,
)


def describe_effect(effect: Effect) -> str:
    """Return the first sentence of an effect's file."""
    function = {
        AirEffect: 'air',
        ActuatorEffect: 'output',
        WrenchEffect: 'wrench',
        InertiaEffect: 'diagonal',
        BodyEffect: 'change',
        MeasurementEffect: 'reading',
    }[type(effect)]
    module = sys.modules[getattr(effect, function).__module__]
    # Up to the first blank line
    text = ' '.join((inspect.getdoc(module) or '').split('\n\n')[0].split())
    return text.rstrip('.')
