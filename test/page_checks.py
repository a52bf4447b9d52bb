# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a page in a browser complains of, requests and draws."""

from pathlib import Path

# Chromium without a graphics card reads WebGL images back, and says that this is slow
DRIVER = 'GL Driver Message'
# Traces and drawn marks of each figure; a figure without marks is blank
COUNT_PANELS = """
[...document.querySelectorAll('.plot')].map((plot) => {
  const paper = plot.querySelector('svg.main-svg');
  const box = paper ? paper.getBoundingClientRect() : { width: 0, height: 0 };
  const marks = plot.querySelectorAll(
    '.scatterlayer path, .heatmaplayer image, .contourlayer path, canvas').length;
  return { name: plot.dataset.panel, traces: plot.data ? plot.data.length : 0, marks,
           width: box.width, height: box.height };
})"""


def find_overlapping_labels(browser):
    """Return the labels of the open page that overprint others or are cut off, in words."""
    return browser.evaluate(Path(__file__).with_name('overlaps.js').read_text(encoding='utf-8'))


def collect_errors(browser):
    """Return console messages and uncaught errors of the page."""
    messages = []
    for method, event in browser.events:
        if method == 'Runtime.consoleAPICalled':
            messages.append(' '.join(str(part.get('value', part)) for part in event['args']))
        elif method == 'Runtime.exceptionThrown':
            messages.append(format_exception(event['exceptionDetails']))
        elif method == 'Log.entryAdded' and DRIVER not in event['entry']['text']:
            messages.append(event['entry']['text'])
    return messages


def format_exception(details):
    """Return an uncaught error as text."""
    return str(details.get('exception', {}).get('description', details['text']))


def list_requests(browser, page):
    """Return every requested address except the page itself and embedded data."""
    urls = [
        event['request']['url']
        for method, event in browser.events
        if method == 'Network.requestWillBeSent'
    ]
    return [url for url in urls if url != page.resolve().as_uri() and not url.startswith('data:')]
