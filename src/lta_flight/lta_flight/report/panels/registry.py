"""The figures of a flight page, in reading order."""

from collections.abc import Callable
from typing import Final, final, NamedTuple

from lta_flight.report.panels import (
    airspeed,
    altitude,
    duty,
    heading,
    light,
    path,
    power,
    samples,
    spectrum,
)
from lta_flight.report.view import FlightView
from plotly.graph_objects import Figure


@final
class FlightPanel(NamedTuple):
    """One figure of the page."""

    name: str  # identifier in the page and in file names
    title: str  # heading
    caption: str  # what the figure shows, in a sentence or two
    needs: tuple[str, ...]  # required topics
    picture: Callable[[FlightView], Figure]  # builds the figure from the flight
    timed: bool = True  # whether the x axis is the time of the flight


PANELS: Final = (
    FlightPanel(
        'path',
        'From above',
        'The true path, coloured and labelled by time. Short rays are the measured bearings to '
        'the lamp, darker with a better signal. The dotted line is the path by dead reckoning. '
        'Shading is the direct light of all lamps at flight height; each step is a factor of two.',
        ('ground_truth/odom',),
        path.plot_path,
        timed=False,
    ),
    FlightPanel(
        'altitude',
        'Altitude',
        'Height of the hull centre above the floor. Grey dots are raw readings of the range '
        'finder, converted to the height of the hull centre.',
        ('ground_truth/odom',),
        altitude.plot_altitude,
    ),
    FlightPanel(
        'airspeed',
        'Airspeed',
        'Speed through the air along the nose. The estimate fuses the accelerometer with a drag '
        'model.',
        ('ground_truth/odom',),
        airspeed.plot_airspeed,
    ),
    FlightPanel(
        'heading',
        'Heading',
        'Direction of the nose in the frame of the room. For comparison, the estimate is shifted '
        'here to start at the true heading; on board it starts at zero.',
        ('ground_truth/odom',),
        heading.plot_heading,
    ),
    FlightPanel(
        'light',
        'Light by direction',
        'Amplitude at the frequency of the lamp for each photodiode of the ring, with the nose in '
        'the middle. The line is the true direction to the lamp, the dots are the measured '
        'bearing.',
        ('light/peaks',),
        light.plot_light,
    ),
    FlightPanel(
        'duty',
        'Rotors',
        'Duty that the controller commands for each rotor.',
        ('motors',),
        duty.plot_duty,
    ),
    FlightPanel(
        'power',
        'Power and energy',
        'Electrical power out of the cell and from the solar panel, and the energy taken from the '
        'cell since the recording started, including time on the ground.',
        ('battery',),
        power.plot_power,
    ),
    FlightPanel(
        'samples',
        'Samples of a photodiode',
        'A tenth of a second of raw samples of the brightest photodiode, at the start and at the '
        'end of the search.',
        ('photodiodes',),
        samples.plot_samples,
        timed=False,
    ),
    FlightPanel(
        'spectrum',
        'Spectrum of a photodiode',
        'Spectrum of the same samples. The peak of the lamp is separate from the flicker of mains '
        'lighting. Its odd harmonics are those of a square wave, and the small peaks between them '
        'are higher harmonics aliased by the sampling.',
        ('photodiodes',),
        spectrum.plot_spectrum,
        timed=False,
    ),
)
