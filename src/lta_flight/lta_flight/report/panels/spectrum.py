"""Plot the spectrum of the light, with lamp and mains."""

from lta_flight.report.sample_blocks import select_sample_blocks
from lta_flight.report.view import FlightView
from lta_report.drawing import create_figure, EndLabel, label_ends
from lta_report.palette import LAMP, SOFT
from lta_vlc.spectral.spectrum import amplitude_spectrum
import numpy as np
from plotly.graph_objects import Figure, Scatter

HIGHEST = 1000.0  # Hz; above it there are only higher harmonics
FLOOR = 1e-3  # counts, the least value on the logarithmic axis


def plot_spectrum(view: FlightView) -> Figure:
    """Return a figure of the spectra of two blocks, with lamp and mains marked."""
    figure = create_figure()
    labels = []
    peaks = []
    for moment in select_sample_blocks(view):
        rate = 1.0 / (moment.time[1] - moment.time[0])
        amplitude = amplitude_spectrum(moment.samples[:, None])[:, 0]
        frequency = np.fft.rfftfreq(len(moment.samples), 1.0 / rate)
        in_range = (frequency > 0.0) & (frequency <= HIGHEST)
        values = np.maximum(amplitude[in_range], FLOOR)
        figure.add_trace(
            Scatter(
                x=frequency[in_range].astype(np.float32),
                y=values.astype(np.float32),
                mode='lines',
                line={'color': moment.colour, 'width': 1.4},
                name=moment.where,
                hovertemplate='%{y:.3~g} counts',
            )
        )
        peaks.append(np.log10(values))
        labels.append(EndLabel(moment.where, peaks[-1][-1], moment.colour))
    # The axis is in decades; 0.45 leaves space for the labels above the peaks
    low = float(np.floor(min(np.quantile(peak, 0.02) for peak in peaks)))
    high = float(max(peak.max() for peak in peaks)) + 0.45
    figure.update_yaxes(title_text='amplitude [counts]', type='log', dtick=1)
    label_ends(figure, labels, (low, high))
    figure.update_xaxes(title_text='frequency [Hz]', range=[0, HIGHEST], tickangle=0)
    figure.update_xaxes(unifiedhovertitle_text='%{x} Hz')
    label_frequencies(figure, view)
    return figure


def label_frequencies(figure: Figure, view: FlightView) -> None:
    """Label the fundamental of each lamp, harmonics of a single lamp, and the mains flicker."""
    scenario = view.scene.scenario
    if scenario is None:
        return
    mains = scenario.ambient.mains_frequency.si
    marks = [(mains, 'mains', SOFT, 'right')]
    marks += [(beat, f'{name} {beat:g} Hz', LAMP, 'left') for name, beat in scenario.beacons]
    if len(scenario.beacons) == 1:
        ((_, beat),) = scenario.beacons
        # The odd harmonics of a square wave
        marks += [(k * beat, f'{k} f', LAMP, 'left') for k in (3, 5) if k * beat <= HIGHEST]
    harmonics = {f'{k} f' for k in (3, 5)}
    for frequency, text, colour, side in marks:
        figure.add_vline(
            frequency, line={'color': colour, 'width': 1, 'dash': 'dot'}, layer='below'
        )
        figure.add_annotation(
            x=frequency, y=1.0, yref='paper', xanchor=side,
            # Harmonics inside the axes, or the name of the lamp would cover them
            yanchor='top' if text in harmonics else 'bottom',
            text=text, font={'color': colour, 'size': 11},
        )  # fmt: skip
