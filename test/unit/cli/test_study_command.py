"""Tests of the output options that every study gets."""

import json

from lta_bridge.provenance import read_commit
from lta_cli.app import build_app
from lta_cli.options.study_command import (
    add_origin,
    drop_output_options,
    show_resume_command,
    study_command,
    StudyRun,
)
from lta_config.errors import BadInput
from lta_report.report import Report, TextTable
import pytest
from rich.console import Console
import typer
from typer.testing import CliRunner


@pytest.fixture
def invoke(tmp_path, monkeypatch):
    """Run a small study that fails below zero."""
    monkeypatch.chdir(tmp_path)

    @study_command('tiny', quick={'number': 0.5}, resumes=False)
    def tiny(number: float = 1.0, *, run: StudyRun) -> Report:
        """Measure a number."""
        if number < 0.0:
            raise BadInput('--number is negative; give a positive one.')
        run.console.print('busy')
        table = TextTable('Numbers', ('name', 'value'), [('number', f'{number:g}')])
        return Report('tiny', '', f'The number is {number:g}.', '', [], [table], {'n': number})

    app = typer.Typer()
    app.command()(tiny)
    return lambda *words: CliRunner().invoke(app, words)


def test_a_study_writes_json_and_page_and_prints_its_table(invoke, tmp_path):
    done = invoke('--number', '3', '--out', 'results')
    assert done.exit_code == 0, done.output
    assert sorted(each.name for each in (tmp_path / 'results').iterdir()) == [
        'report.html', 'tiny.json'
    ]  # fmt: skip
    assert json.loads((tmp_path / 'results/tiny.json').read_text()) == {'n': 3.0}
    assert done.stdout.splitlines()[-2:] == [
        'The number is 3.',
        'Page results/report.html  (open it in a browser: xdg-open results/report.html)',
    ]


def test_json_goes_alone_to_stdout(invoke, tmp_path):
    done = invoke('--json', '--out', 'results')
    assert json.loads(done.stdout) == {'n': 1.0, 'page': str(tmp_path / 'results/report.html')}
    assert 'busy' in done.stderr
    assert 'The number is 1.' in done.stderr


@pytest.mark.parametrize(
    ('words', 'number'),
    [(('--quick',), 0.5), (('--quick', '--number', '2'), 2.0), (('--quick', '--number=1.0'), 1.0)],
)
def test_a_quick_study_keeps_what_the_user_gives(invoke, words, number):
    assert json.loads(invoke(*words, '--no-page', '--json').stdout) == {'n': number}
    words = invoke('--help').stdout.replace('│', ' ').split()
    assert 'The same as --number 0.5.' in ' '.join(words)


def test_without_a_page(invoke, tmp_path):
    done = invoke('--no-page', '--json', '--out', 'results')
    assert json.loads(done.stdout) == {'n': 1.0}
    assert [each.name for each in (tmp_path / 'results').iterdir()] == ['tiny.json']
    assert 'Page' not in done.stderr
    refused = invoke('--no-page', '--pictures', 'png')
    assert isinstance(refused.exception, BadInput)
    assert not (tmp_path / 'png').exists()


def test_the_default_folder_carries_the_name(invoke, tmp_path):
    assert invoke().exit_code == 0
    (folder,) = (tmp_path / 'runs').iterdir()
    assert folder.name.endswith('-tiny')


def test_nothing_is_written_for_bad_input(invoke, tmp_path):
    failed = invoke('--number', '-1', '--out', 'results')
    assert isinstance(failed.exception, BadInput)
    assert not (tmp_path / 'results').exists()


def test_a_folder_with_contents_is_refused_before_the_study(invoke, tmp_path):
    (tmp_path / 'results').mkdir()
    (tmp_path / 'results/mine.txt').write_text('x')
    refused = invoke('--out', 'results')
    assert isinstance(refused.exception, BadInput)
    assert 'busy' not in refused.output
    assert [each.name for each in (tmp_path / 'results').iterdir()] == ['mine.txt']


def test_pictures_may_go_into_the_results_folder_and_a_failure_leaves_no_folder(
    invoke, tmp_path, monkeypatch
):
    monkeypatch.setattr('lta_cli.options.common_options.find_chromium', lambda: None)
    failed = invoke('--number', '-1', '--out', 'results', '--pictures', 'results/png')
    assert 'negative' in str(failed.exception)
    assert [*tmp_path.iterdir()] == []
    (tmp_path / 'png').mkdir()
    (tmp_path / 'png/mine.png').write_text('x')
    refused = invoke('--pictures', 'png')
    assert 'is not empty; choose another folder' in str(refused.exception)


def test_a_study_that_resumes_keeps_what_its_folder_has(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    @study_command('', quick='Count less.')
    def counting(*, run: StudyRun) -> Report:
        folder = run.open_folder(tmp_path / 'runs/counting-1')
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / 'log').open('a') as log:
            log.write('x')
        count = len((folder / 'log').read_text())
        return Report('counting', '', f'{count} runs.', '', [], [], {'runs': count})

    app = typer.Typer()
    app.command()(counting)
    for count in (1, 2):
        assert f'{count} runs.' in CliRunner().invoke(app).stdout
    content = json.loads((tmp_path / 'runs/counting-1/counting.json').read_text())
    assert content == {'runs': 2}


def test_a_study_that_stores_its_work_elsewhere_gets_the_folder_of_the_user(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    @study_command('tiny', quick='Nothing.')
    def tiny() -> Report:
        """Do nothing that is stored."""
        return Report('tiny', '', 'Done.', '', [], [], {})

    app = typer.Typer()
    app.command()(tiny)
    done = CliRunner().invoke(app, ['--out', 'deep/results', '--no-page'])
    assert done.exit_code == 0, done.output
    assert (tmp_path / 'deep/results/tiny.json').exists()
    (tmp_path / 'file').touch()
    done = CliRunner().invoke(app, ['--out', 'file/results', '--no-page'])
    assert isinstance(done.exception, BadInput)
    assert 'cannot be created (Not a directory); choose another folder' in str(done.exception)


def test_a_stopped_study_says_how_to_resume_in_its_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run = StudyRun(Console(), tmp_path / 'runs/1-platforms', None, True)
    show_resume_command(['platforms', '--json', '--seeds', '3'], run)
    assert capsys.readouterr().out == ''  # nothing is stored yet
    run.folder.mkdir(parents=True)
    (run.folder / 'rows.jsonl').touch()
    show_resume_command(['platforms', '--json', '--seeds', '3'], run)
    assert capsys.readouterr().out == (
        'Finished work is stored; resume with: lta platforms --seeds 3 --out runs/1-platforms\n'
    )


def test_a_study_that_resumes_is_repeated_in_its_folder(tmp_path):
    report = Report('counting', '', 'Done.', '', [], [], {}, commands={'Fly': 'lta fly'})
    words = ['counting', '--out', 'old', '--json']
    found = add_origin(report, words, tmp_path / 'kept').commands
    assert found == {
        'Resume or repeat this study': f'lta counting --out {tmp_path / "kept"}',
        'Fly': 'lta fly',
    }
    # A report that was not made by a command line has no command that repeats it
    assert add_origin(report, (), None).commands == {'Fly': 'lta fly'}


def test_the_page_says_how_to_repeat_it_and_by_which_commit(tmp_path):
    words = ['cells', '--budget', '30 g', '--out', str(tmp_path / 'out')]
    done = CliRunner().invoke(build_app(), words)
    assert done.exit_code == 0, done.output
    page = (tmp_path / 'out/report.html').read_text()
    assert 'lta cells --budget &#x27;30 g&#x27;</code>' in page
    assert f'<dd>{read_commit()}</dd>' in page


@pytest.mark.parametrize(
    'words',
    [
        ['--json', 'light', '--out', 'x', '--seeds', '3'],
        ['light', '--out=x', '--seeds', '3', '--no-page'],
        ['light', '--seeds', '3', '--pictures', 'y', '--out', 'x'],
    ],
)
def test_a_repeated_command_writes_to_a_folder_of_its_own(words):
    assert drop_output_options(words) == ['light', '--seeds', '3']
