"""Every study takes the same options, each declared once; a report takes those of its output."""

from pathlib import Path
import re

from lta_cli.app import build_app, FOLDER, VerbGroup, VERBS
import pytest
from typer.main import get_command

OUTPUT = {'--out', '--json', '--no-page', '--pictures'}
COMPUTING = {'--workers', '--scheduler', '--quick', '--retry-failed'}
# Each computes one thing, so there is nothing to share out, shorten or resume
REPORTS = {
    'calibrate', 'cells', 'compare', 'discover', 'effects try', 'energy breakeven',
    'hardware light', 'light calibrate', 'light link', 'replay', 'tests between', 'tests plan',
    'tests read',
}  # fmt: skip


def list_verbs():
    """Yield the words of every verb, and its file."""
    for name, verb in VERBS.items():
        inner = verb.verbs if isinstance(verb, VerbGroup) else {'': verb}
        for word, each in inner.items():
            yield f'{name} {word}'.strip(), FOLDER / f'{each.file.replace(".", "/")}.py'


@pytest.fixture(scope='module')
def commands():
    """Return every command by its words."""
    app = get_command(build_app())
    found = {}
    for words, _ in list_verbs():
        command = app.commands.get(words)
        if command is None:
            group, word = words.split()
            command = app.commands[group].commands[word]
        found[words] = command
    return found


@pytest.fixture(scope='module')
def options(commands):
    """Return the options of every command by its words."""
    return {
        words: {text for each in command.params for text in (*each.opts, *each.secondary_opts)}
        for words, command in commands.items()
    }


def test_out_is_a_folder_and_file_a_file_in_every_command(commands):
    for words, command in commands.items():
        for each in command.params:
            if '--out' in each.opts:
                assert each.help.startswith('Folder '), words
            if '--file' in each.opts:
                assert ' file to write' in each.help, words


def list_files(decorator):
    return {words for words, file in list_verbs() if f'@{decorator}(' in file.read_text()}


def test_every_study_takes_the_whole_set(options):
    studies = list_files('study_command')
    assert len(studies) > 10
    assert {words for words in studies if not options[words] >= OUTPUT | COMPUTING} == set()


def test_a_command_with_a_page_and_pictures_is_a_study_or_one_of_the_known_reports(options):
    assert list_files('report_command') == REPORTS
    assert {words for words in REPORTS if options[words] & COMPUTING} == set()
    # What retries failed items or uses a cluster is a study
    others = options.keys() - list_files('study_command')
    assert {
        words for words in others if options[words] & {'--scheduler', '--retry-failed'}
    } == set()


def test_no_verb_declares_an_option_of_all_studies(options):
    names = '|'.join(sorted((COMPUTING | OUTPUT) - {'--workers', '--out', '--json'}))
    for words in list_files('study_command') | REPORTS:
        file = dict(list_verbs())[words]
        text = Path(file).read_text()
        assert not re.search(rf"'(?:{names})'", text), words
        assert not re.search(r'WorkerCount|\bOut\b|\bJson\b|RetryFailed', text), words
