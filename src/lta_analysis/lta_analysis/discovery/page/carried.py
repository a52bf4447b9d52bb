"""What names rest on that forecasts gave, as HTML: what each is worth, and regimes left out."""

from html import escape

from lta_analysis.discovery.finding import Finding
from lta_analysis.discovery.page import strips
from lta_analysis.discovery.page.tables import table
from lta_analysis.discovery.page.words import figure, listed, percent


def carried(found: Finding) -> str:
    """Return what carries over, regime by regime; '' where the readings gave the names."""
    told = found.carried
    if told is None:
        return ''
    most = max(one.share for one in told.names)
    names = [
        (escape(one.name), strips.bar(one.share, most), f'{figure(100.0 * one.share, 2)} %')
        for one in told.names
    ]
    regimes = [(escape(one.name), str(one.flights), figure(one.ratio, 2)) for one in told.regimes]
    worst = percent(max(one.ratio for one in told.regimes) - 1.0)
    lost = (
        f'<p class="note">Interpolation only, so not named: <b>'
        f'{escape(listed(told.interpolates))}</b>.</p>'
        if told.interpolates
        else ''
    )
    return (
        '<h3>By forecasts: what carries over</h3>'
        '<p class="note">What the model misses is so large, or the poses are so smooth, that '
        'readings decide nothing; a forecast of five seconds does. A name is kept if it makes '
        'forecasts better in regimes that were left out of its fit, and between the flights that '
        'taught and those that confirmed, both ways.</p>'
        + table(('name', '', 'of the squared error'), names, 'plain', 'What each name is worth')
        + f'{lost}<p class="note">Each regime by what the others teach, error by that of the '
        f'vehicle file; in the worst of them it changes by {worst} %.</p>'
        + table(('left out', 'flights', 'error'), regimes, 'plain', 'Regimes left out')
        + '<h3>By readings</h3>'
    )
