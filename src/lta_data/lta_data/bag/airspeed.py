"""Find the estimated airspeed in a bag."""

from collections.abc import Collection


def find_airspeed_topic(topics: Collection[str]) -> str:
    """
    Return the topic whose twist is the estimated velocity through the air.

    In version 1.0 there was no topic `airspeed`: `odom` had the velocity through the air, and
    its x and y were dead reckoning through the air.
    """
    return 'airspeed' if 'airspeed' in topics else 'odom'
