# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A request as a command and as a function of Python: options, folders, resume and messages."""

import inspect
import json
from pathlib import Path

import lta_analysis
from lta_analysis.door import as_function
from lta_analysis.result import StudyResult
from lta_bag.provenance import read_commit
from lta_cli.app import build_app
from lta_cli.request_command import build_command
from lta_config.errors import BadInput
from lta_report.report import Report, TextTable
from lta_report.request import (
    Action,
    argument,
    Changes,
    Mass,
    option,
    Outcome,
    ReportRequest,
    StudyRequest,
)
import numpy as np
import pytest
import typer
from typer.testing import CliRunner


class Tiny(StudyRequest, command='tiny', quick={'number': 0.5}, resumes=False):
    """
    Measure a number.

    Exit status 0: done.
    """

    name: str = argument('Whose number.', default='a')
    number: float = option('The number in m.', default=1.0, high=9.0)
    each: tuple[int, ...] = option('Some numbers.', default=(1, 2), low=0)
    mass: Mass = option('A mass.', default='6 g')
    changes: Changes = option('Changes.', default={}, name='set')

    def run(self, run):
        if self.number < 0.0:
            raise BadInput('--number is negative; give a positive one.')
        run.console.print('busy')
        table = TextTable('Numbers', ('name', 'value'), [('number', f'{self.number:g}')])
        data = {
            'n': self.number,
            'rows': [{'each': each} for each in self.each],
            'named': {'a': {'x': {'y': 1.0}}, 'b': {'x': {'y': 2.0}}},
        }
        return Report('tiny', '', f'The number is {self.number:g}.', '', [], [table], data)


class Counting(StudyRequest, command='counting', quick='Count less.'):
    """Count how often it ran."""

    stop: bool = option('Stop.', default=False)

    def run(self, run):
        folder = run.open_folder(Path('runs/counting-1'))
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / 'log').open('a') as log:
            log.write('x')
        if self.stop:
            raise KeyboardInterrupt
        count = len((folder / 'log').read_text())
        return Report('counting', '', f'{count} runs.', '', [], [], {'runs': count})


@pytest.fixture
def invoke(tmp_path, monkeypatch):
    """Run a small study that fails below zero."""
    monkeypatch.chdir(tmp_path)

    def run(*words, request=Tiny):
        app = typer.Typer()
        app.command()(build_command(request))
        return CliRunner().invoke(app, words)

    return run


def test_a_study_writes_json_and_page_and_prints_its_table(invoke, tmp_path):
    done = invoke('--number', '3', '--out', 'results')
    assert done.exit_code == 0, done.output
    names = sorted(each.name for each in (tmp_path / 'results').iterdir())
    assert names == ['report.html', 'tiny.json']
    assert json.loads((tmp_path / 'results/tiny.json').read_text())['n'] == 3.0
    assert done.stdout.splitlines()[-2:] == [
        'The number is 3.',
        'Page results/report.html  (open it in a browser: xdg-open results/report.html)',
    ]


def test_json_goes_alone_to_stdout(invoke, tmp_path):
    done = invoke('--json', '--out', 'results')
    content = json.loads(done.stdout)
    assert (content['n'], content['page']) == (1.0, str(tmp_path / 'results/report.html'))
    assert 'busy' in done.stderr
    assert 'The number is 1.' in done.stderr


@pytest.mark.parametrize(
    ('words', 'number'),
    [(('--quick',), 0.5), (('--quick', '--number', '2'), 2.0), (('--quick', '--number=1.0'), 1.0)],
)
def test_a_quick_study_keeps_what_the_user_gives(invoke, words, number):
    assert json.loads(invoke(*words, '--no-page', '--json').stdout)['n'] == number
    options = {'quick': True} | ({} if number == 0.5 else {'number': number})
    assert as_function(Tiny)(**options, page=False)['n'] == number
    text = ' '.join(invoke('--help').stdout.replace('│', ' ').split())
    assert 'The same as --number 0.5.' in text


def test_without_a_page(invoke, tmp_path):
    done = invoke('--no-page', '--json', '--out', 'results')
    assert 'page' not in json.loads(done.stdout)
    assert [each.name for each in (tmp_path / 'results').iterdir()] == ['tiny.json']
    refused = invoke('--no-page', '--pictures', 'png')
    assert isinstance(refused.exception, BadInput)
    assert not (tmp_path / 'png').exists()


def test_the_default_folder_carries_the_name(invoke, tmp_path):
    assert invoke().exit_code == 0
    (folder,) = (tmp_path / 'runs').iterdir()
    assert folder.name.endswith('-tiny')


def test_nothing_is_written_for_bad_input_or_over_other_files(invoke, tmp_path, monkeypatch):
    monkeypatch.setattr('lta_analysis.door.find_chromium', lambda: None)
    failed = invoke('--number', '-1', '--out', 'results', '--pictures', 'results/png')
    assert 'negative' in str(failed.exception)
    assert [*tmp_path.iterdir()] == []
    for folder in ('results', 'png'):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / 'mine.txt').write_text('x')
    for words in (('--out', 'results'), ('--pictures', 'png')):
        refused = invoke(*words)
        assert 'is not empty; choose another folder' in str(refused.exception)
        assert 'busy' not in refused.output
    assert [each.name for each in (tmp_path / 'results').iterdir()] == ['mine.txt']


def test_a_study_that_resumes_goes_on_in_its_folder(invoke, tmp_path):
    for count in (1, 2):
        done = invoke(request=Counting)
        assert f'{count} runs.' in done.stdout
    page = (tmp_path / 'runs/counting-1/report.html').read_text()
    assert 'lta counting --out runs/counting-1</code>' in page
    assert 'Resume or repeat this study' in page
    stopped = invoke('--stop', '--json', request=Counting)
    assert 'resume with: lta counting --stop --out runs/counting-1' in stopped.stderr
    (tmp_path / 'file').touch()
    refused = invoke('--out', 'file/results', request=Counting)
    assert 'file/results' in str(refused.exception)


def test_the_page_says_how_to_repeat_it_and_by_which_commit(tmp_path):
    words = ['cells', '--budget', '30 g', '--out', str(tmp_path / 'out')]
    done = CliRunner().invoke(build_app(), words)
    assert done.exit_code == 0, done.output
    page = (tmp_path / 'out/report.html').read_text()
    assert 'lta cells --budget &#x27;30 g&#x27;</code>' in page
    assert f'<dd>{read_commit()}</dd>' in page


def test_python_gets_what_the_command_gets(invoke, tmp_path):
    result = as_function(Tiny)(
        'b', number=np.float64(2.0), each=np.array([3, 4]), mass=0.02,
        changes={'vehicle.trim.heaviness': '4 g'}, out=tmp_path / 'out',
    )  # fmt: skip
    own = result.request
    assert (own.name, own.number, own.each, own.mass) == ('b', 2.0, (3, 4), 0.02)
    assert own.changes == {'vehicle.trim.heaviness': {'value': 4, 'unit': 'g'}}
    assert own.format_repetition(result.folder) == (
        "lta tiny b --number 2.0 --each 3 --each 4 --mass '20 g' "
        "--set 'vehicle.trim.heaviness=4.0 g'"
    )
    words = ['--set', 'vehicle.trim.heaviness=4 g', '--mass', '20 g', '--each', '3', '--each', '4']
    assert invoke('b', '--number', '2', *words).exit_code == 0
    # The record of what was run builds the same request again
    assert Tiny(**own.model_dump(mode='json')) == own
    assert repr(result) == 'tiny: The number is 2.'
    assert result.to_pandas()['each'].tolist() == [3, 4]
    assert result.to_pandas('named').loc['b', 'x.y'] == 2.0
    assert '<td>2</td>' in result._repr_html_()
    assert (result['n'], list(result.tables), result.page.exists()) == (2.0, ['Numbers'], True)
    with pytest.raises(BadInput, match="'n' has no rows in these results; choose one of: rows"):
        result.to_pandas('n')


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        ({'number': 10}, 'number is 10, but must be 9 or less.'),
        ({'each': -1}, 'each is -1, but must be 0 or more.'),
        ({'each': 1.5}, 'each is 1.5, but must be a whole number.'),
        ({'out': 5}, 'out is 5, but must be a path.'),
        ({'changes': 3}, 'changes is 3, but must be values by path'),
        ({'mass': '6 s'}, "mass '6 s' is not a mass; give a number with a unit, such as '6 g'."),
        ({'numbr': 1}, "Unknown argument 'numbr'; known: .*did you mean 'number'"),
        ({'changes': ['x']}, "'x' is not an assignment"),
        ({'out': ' '}, 'out is empty; give a folder or file.'),
    ],
)
def test_python_is_told_in_one_sentence(options, message):
    with pytest.raises(BadInput, match=message):
        as_function(Tiny)(**options)


def test_what_is_missing_is_named():
    with pytest.raises(BadInput, match='vehicle is missing: Vehicle to calibrate'):
        lta_analysis.calibrate(train='x')


@pytest.mark.parametrize('name', lta_analysis.FUNCTIONS)
def test_every_function_is_documented_and_studies_take_the_shared_options(name):
    function = getattr(lta_analysis, name)
    signature = inspect.signature(function)
    names = list(signature.parameters)
    if signature.return_annotation is StudyResult:
        assert names[-3:] == ['out', 'page', 'pictures']
    lines = function.__doc__.splitlines()
    for each in names:
        place = next(k for k, line in enumerate(lines) if line.startswith(f'{each} : '))
        assert lines[place + 1].strip(), each
    assert 'Example: lta' not in function.__doc__
    assert name in dir(lta_analysis)


class Adding(Action, command='adding', json=True):
    """Add two numbers."""

    a: int = argument('A number.')
    b: int = option('Another one.', default=1, low=0)

    def run(self, console) -> Outcome[int]:
        """Print the sum, and return it."""
        console.print(f'The sum is {self.a + self.b}.')
        return Outcome(self.a + self.b, {'sum': self.a + self.b}, status=int(self.a < 0))


class Silent(Action, command='silent'):
    """Do nothing."""

    def run(self, console) -> Outcome[None]:
        return Outcome(None)


def test_an_action_prints_returns_and_exits(invoke):
    done = invoke('2', '--b', '3', request=Adding)
    assert (done.stdout, done.exit_code) == ('The sum is 5.\n', 0)
    done = invoke('--json', '--', '-2', request=Adding)
    assert (json.loads(done.stdout), done.stderr) == ({'sum': -1}, 'The sum is -1.\n')
    assert done.exit_code == 1
    assert as_function(Adding)(2, b=3) == 5
    with pytest.raises(BadInput, match='b is -1, but must be 0 or more'):
        as_function(Adding)(2, b=-1)
    assert '--json' not in invoke('--help', request=Silent).stdout


def test_a_report_is_no_study():
    assert not {'workers', 'quick'} & set(ReportRequest.model_fields)
