"""The pictures of a flight page, in reading order."""

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
    """
    One picture of the page.

    Attributes
    ----------
    name : str
        Identifies it in the page and in file names.
    title : str
        Its heading.
    caption : str
        What is to be seen, in a sentence or two.
    needs : tuple of str
        Topics without which there is nothing to draw.
    picture : callable
        From the flight to the figure.
    timed : bool
        Whether its x axis is the time of the flight.

    """

    name: str
    title: str
    caption: str
    needs: tuple[str, ...]
    picture: Callable[[FlightView], Figure]
    timed: bool = True


PANELS: Final = (
    FlightPanel(
        'path',
        'From above',
        'The true path, coloured and labelled by time. Short rays are the bearings to the lamp as '
        'the drone measured them, stronger in colour with a better signal; the dotted line is '
        'where it would believe to be by dead reckoning. Shading is the direct light of all lamps '
        'at flight height, a step for each factor of two.',
        ('ground_truth/odom',),
        path.plot_path,
        timed=False,
    ),
    FlightPanel(
        'altitude',
        'Altitude',
        'Height of the hull centre above the floor; grey dots are the raw range finder, raised to '
        'the hull centre.',
        ('ground_truth/odom',),
        altitude.plot_altitude,
    ),
    FlightPanel(
        'airspeed',
        'Airspeed',
        'Speed through the air along the nose. The estimate fuses the accelerometer with a drag '
        'model; it never sees the truth.',
        ('ground_truth/odom',),
        airspeed.plot_airspeed,
    ),
    FlightPanel(
        'heading',
        'Heading',
        'Where the nose points, in the frame of the room. The estimate starts from the true '
        'heading here, for comparison; on board it starts from zero.',
        ('ground_truth/odom',),
        heading.plot_heading,
    ),
    FlightPanel(
        'light',
        'Light by direction',
        'Amplitude at the frequency of the lamp for each diode of the ring, nose in the middle. '
        'The line is the true direction to the lamp, the dots are the measured bearing.',
        ('light/peaks',),
        light.plot_light,
    ),
    FlightPanel(
        'duty',
        'Rotors',
        'Duty that the controller asks of each rotor.',
        ('motors',),
        duty.plot_duty,
    ),
    FlightPanel(
        'power',
        'Power and energy',
        'Electrical power out of the cell and from the solar panel, and the energy taken from the '
        'cell since the recording started, standing on the ground included.',
        ('battery',),
        power.plot_power,
    ),
    FlightPanel(
        'samples',
        'What a photodiode hears',
        'A tenth of a second of raw samples of the brightest diode, when the search starts and '
        'when it ends.',
        ('photodiodes',),
        samples.plot_samples,
        timed=False,
    ),
    FlightPanel(
        'spectrum',
        'The lamp in the spectrum',
        'The same samples by frequency. The lamp has its own place beside the flicker of the '
        'mains, its odd harmonics show that it is a square wave, and the small peaks between '
        'them are high harmonics that the sampling folds back.',
        ('photodiodes',),
        spectrum.plot_spectrum,
        timed=False,
    ),
)
