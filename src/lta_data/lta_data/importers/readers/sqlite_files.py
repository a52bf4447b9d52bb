"""
Prepare the SQLite files of a recording, so that rosbags reads all that is in them.

rosbags opens a file alone. A recorder that was killed leaves part of it in a write-ahead log
beside it (NAME.db3-wal), and a full disk or a broken copy leaves a file without its end. Both are
made whole in a temporary copy; the files themselves stay as they are.
"""

from contextlib import closing
from pathlib import Path
import shutil
import sqlite3
from tempfile import mkdtemp
from typing import Final, final, NamedTuple
import weakref

from lta_config.errors import BadInput
from lta_data.importers.readers.bag_safety_checks import refuse_programs, refuse_unsafe_messages

SCHEMA: Final = (
    'CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, '
    'serialization_format TEXT, offered_qos_profiles TEXT)',
    'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, '
    'data BLOB)',
)
LONGEST: Final = 1000  # times what is left of it, a file may have been long
LOGGED: Final = b'\2\2'  # bytes 18 and 19 of a file with a write-ahead log
TOPICS: Final = 'id, name, type, serialization_format'


@final
class PreparedFiles(NamedTuple):
    """The files to read, and remarks on what was done."""

    files: list[Path]
    notes: list[str]


@final
class CopyFolder:
    """A folder for copies, made when it is needed and gone with its owner."""

    def __init__(self) -> None:
        self._path: Path | None = None

    def name_copy(self, name: str) -> Path:
        """Return the path of a new copy."""
        if self._path is None:
            self._path = Path(mkdtemp(prefix='lta-bag-'))
            weakref.finalize(self, shutil.rmtree, self._path, ignore_errors=True)
        return self._path / name


def prepare_files(files: list[Path], copies: CopyFolder) -> PreparedFiles:
    """Return the files of a recording, or whole copies of them; raise `BadInput` if none is."""
    prepared = PreparedFiles([], [])
    for file in files:
        log = file.with_name(f'{file.name}-wal')
        has_log = log.is_file() and log.stat().st_size > 0
        whole = file
        if has_log or _awaits_log(file):
            whole = copies.name_copy(file.name)
            shutil.copyfile(file, whole)
            if has_log:
                shutil.copyfile(log, whole.with_name(log.name))
                prepared.notes.append(
                    f'{log.name} was read, too: the recorder did not close the bag.'
                )
            _merge_log(whole)
        padded = _pad(whole, copies)
        refuse_programs(padded)
        if padded != whole or _is_damaged(whole):
            count, rescued = _rescue_messages(padded, copies)
            prepared.notes.append(
                f"'{file}' is damaged: {count} messages before the damage are read, and any "
                'others are lost.'
            )
            whole = rescued
        refuse_unsafe_messages(whole)
        prepared.files.append(whole)
    return prepared


def _awaits_log(file: Path) -> bool:
    """Return whether a file says that it has a write-ahead log, which SQLite would create."""
    with file.open('rb') as stream:
        return stream.read(20)[18:20] == LOGGED


def _merge_log(file: Path) -> None:
    """Move what is in a write-ahead log into its file; raise `BadInput` if that is damaged."""
    try:
        with closing(sqlite3.connect(file)) as base:
            base.execute('PRAGMA trusted_schema = OFF')
            base.execute('PRAGMA wal_checkpoint(TRUNCATE)')
            base.execute('PRAGMA journal_mode = DELETE')
    except sqlite3.DatabaseError as error:
        raise BadInput(
            f"The write-ahead log '{file.name}-wal' cannot be read ({error}); copy it again from "
            'the recorder, or remove it to read what its file has.'
        ) from None


def _is_damaged(file: Path) -> bool:
    """Return whether the messages of a file cannot all be read."""
    try:
        with closing(sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)) as base:
            for _ in base.execute('SELECT length(data), topic_id, timestamp FROM messages'):
                pass
            # rosbags reads them by their index of times
            base.execute('SELECT max(timestamp), min(timestamp) FROM messages').fetchone()
    except sqlite3.OperationalError:
        return False  # not the tables of a recording, which rosbags says
    except sqlite3.DatabaseError:
        return True
    return False


def _pad(file: Path, copies: CopyFolder) -> Path:
    """Return a file, or a copy with empty pages where it was cut off: SQLite opens no other."""
    with file.open('rb') as stream:
        head = stream.read(32)
    # Bytes 16 and 17: size of a page, where 1 stands for 65536; from 28 on: number of pages
    page = int.from_bytes(head[16:18], 'big')
    size = (65536 if page == 1 else page) * int.from_bytes(head[28:32], 'big')
    if not file.stat().st_size < size <= file.stat().st_size * LONGEST:
        return file
    padded = copies.name_copy(f'padded_{file.name}')
    shutil.copyfile(file, padded)
    with padded.open('r+b') as stream:
        stream.truncate(size)
    return padded


def _rescue_messages(file: Path, copies: CopyFolder) -> tuple[int, Path]:
    """Copy the messages of the intact pages; return their number and the new file."""
    rescued = copies.name_copy(f'rescued_{file.name}')
    count = 0
    with (
        closing(sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)) as base,
        closing(sqlite3.connect(rescued)) as copy,
    ):
        for statement in SCHEMA:
            copy.execute(statement)
        try:
            base.execute('PRAGMA trusted_schema = OFF')
            rows = base.execute(f'SELECT {TOPICS} FROM topics').fetchall()
            copy.executemany("INSERT INTO topics VALUES(?, ?, ?, ?, '')", rows)
            # By their number, as they were written: the pages follow each other
            there = {row[0] for row in rows}
            for row in base.execute('SELECT id, topic_id, timestamp, data FROM messages'):
                if row[1] not in there or not row[2] or not isinstance(row[3], bytes):
                    break
                copy.execute('INSERT INTO messages VALUES(?, ?, ?, ?)', row)
                count += 1
        except sqlite3.DatabaseError as error:
            if not count:
                raise BadInput(
                    f"'{file}' cannot be read ({error}), and no message in it is intact; copy it "
                    'again from the recorder.'
                ) from None
        copy.commit()
    return count, rescued
