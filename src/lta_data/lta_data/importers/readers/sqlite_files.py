# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Refuse hostile bags, and prepare SQLite files, so that rosbags reads all that is in them.

rosbags opens a file alone. A recorder that was killed leaves part of it in a write-ahead log
beside it (NAME.db3-wal), and a full disk or a broken copy leaves a file without its end. Both are
made whole in a temporary copy; the files themselves stay as they are.
"""

from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
import shutil
import sqlite3
from tempfile import mkdtemp
from typing import Final, final, NamedTuple
import weakref

from lta_bag.bag_folder import natural_sort_key
from lta_config.errors import BadInput
from lta_config.files import load_yaml, parse_yaml
from lta_config.limits import CHUNK_BYTES, INFLATED_FREELY, INFLATION
import zstandard

METADATA = 'metadata.yaml'
QOS_COLUMN = 'offered_qos_profiles'
BYTES_PER_PIECE = 1 << 20  # bytes
# Views, triggers and generated columns run SQL, perhaps without end; a bag has none.
PROGRAMS_QUERY = "SELECT name FROM sqlite_master WHERE type IN ('view', 'trigger') OR sql LIKE ?"
GENERATED_COLUMNS = (2, 3)  # `hidden` values of generated columns in table_xinfo


def find_files(path: Path) -> list[Path]:
    """Return the files of a rosbag2 folder in their order, or the one file."""
    return sorted(path.iterdir(), key=natural_sort_key) if path.is_dir() else [path]


def has_metadata(path: Path) -> bool:
    """Return whether a folder has a metadata.yaml, which a killed recorder does not write."""
    return (path / METADATA).is_file()


def refuse_hostile_bag(path: Path, files: Sequence[Path]) -> None:
    """
    Raise BadInput for a bag that could block rosbags or fill the disk.

    `path` is a rosbag2 folder, or one file; `files` are what it holds.
    """
    if has_metadata(path):
        described = load_yaml(path / METADATA)
        for text in iterate_qos_texts(described):
            parse_yaml(text, f"The QoS in '{path / METADATA}'")
    for file in files:
        if file.suffix in ('.zstd', '.zst'):
            refuse_decompression_bomb(file)


def iterate_qos_texts(held: object) -> Iterator[str]:
    """Yield every text of a metadata.yaml that rosbags parses as YAML again."""
    if isinstance(held, dict):
        for key, inside in held.items():
            if key == QOS_COLUMN and isinstance(inside, str):
                yield inside
            yield from iterate_qos_texts(inside)
    elif isinstance(held, list):
        for inside in held:
            yield from iterate_qos_texts(inside)


def refuse_decompression_bomb(file: Path) -> None:
    """Raise BadInput for a compressed file that would fill the disk."""
    done, allowed = 0, INFLATED_FREELY + INFLATION * file.stat().st_size
    try:
        with file.open('rb') as packed:
            stream = zstandard.ZstdDecompressor().stream_reader(packed)
            while piece := stream.read(BYTES_PER_PIECE):
                done += len(piece)
                if done > allowed:
                    raise BadInput(
                        f"'{file}' unpacks to more than {INFLATION} times its size, which no "
                        'recording does; get it from a trusted source.'
                    )
    except zstandard.ZstdError as error:
        raise BadInput(
            f"'{file}' cannot be unpacked ({error}); it is probably damaged, so copy it again."
        ) from None


def refuse_programs(file: Path) -> None:
    """Raise BadInput for a database with computed content, which runs SQL of its own."""
    try:
        with closing(sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)) as base:
            programs = [name for (name,) in base.execute(PROGRAMS_QUERY, ('CREATE VIRTUAL%',))]
            for table in ('messages', 'topics', 'schema', 'message_definitions'):
                for _, name, *_, kind in base.execute(f'PRAGMA table_xinfo({table})'):
                    programs += [name] if kind in GENERATED_COLUMNS else []
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
        raise _unreadable_error(file, error) from None
    if programs:
        raise BadInput(
            f"'{file}' has '{programs[0]}', a view, trigger or computed column, which no "
            'recording has; get it from a trusted source.'
        )


def refuse_unsafe_messages(file: Path) -> None:
    """Raise BadInput for a database with oversized messages."""
    try:
        with closing(sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)) as base:
            for (head,) in base.execute('SELECT substr(data, 1, 18) FROM messages'):
                refuse_large_message(file, head)
            for (text,) in base.execute('SELECT DISTINCT offered_qos_profiles FROM topics'):
                parse_yaml(text or '', f"The QoS in '{file}'")
    except sqlite3.OperationalError as error:
        if QOS_COLUMN not in str(error):  # older bags have no QoS column
            raise _unreadable_error(file, error) from None
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
        raise _unreadable_error(file, error) from None


def _unreadable_error(file: Path, error: Exception) -> BadInput:
    return BadInput(
        f"'{file}' cannot be read ({error}); it is probably damaged, so copy it again."
    )


def refuse_large_message(file: Path, head: object) -> None:
    """Raise BadInput for a compressed message that is too large."""
    if isinstance(head, bytes) and head[:4] == zstandard.FRAME_HEADER:
        size = zstandard.frame_content_size(head)
        if size < 0 or size > CHUNK_BYTES:
            raise BadInput(
                f"'{file}' has a message that decompresses to more than {CHUNK_BYTES} bytes; "
                'copy the bag without the topic of that message (ros2 bag convert) and import '
                'the copy.'
            )


SCHEMA: Final = (
    'CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, '
    'serialization_format TEXT, offered_qos_profiles TEXT)',
    'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, '
    'data BLOB)',
)
MAX_CUT_RATIO: Final = 1000  # times what is left of it, a file may have been long
LOGGED: Final = b'\2\2'  # bytes 18 and 19 of a file with a write-ahead log
TOPIC_COLUMNS: Final = 'id, name, type, serialization_format'


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
    if not file.stat().st_size < size <= file.stat().st_size * MAX_CUT_RATIO:
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
            rows = base.execute(f'SELECT {TOPIC_COLUMNS} FROM topics').fetchall()
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
