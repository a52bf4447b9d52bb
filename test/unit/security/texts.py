# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hostile texts of YAML: each function writes one into a folder and returns its path."""

from pathlib import Path

from lta_config.files import find_file


def written(folder, data, name='hostile.yaml'):
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def changed(folder, old, new, kind='vehicle', name='gtmab'):
    """Write a shipped file with one piece of it replaced."""
    text = Path(find_file(kind, name)).read_text()
    assert old in text, old
    return written(folder, text.replace(old, new, 1))


def bomb(folder):
    layers = [f'a{k}: &a{k} [{", ".join(10 * [f"*a{k - 1}"])}]' for k in range(1, 12)]
    return written(folder, '\n'.join(['a0: &a0 [x]', *layers]))


def merge_bomb(folder):
    layers = [f'a{k}: &a{k} {{<<: [{", ".join(30 * [f"*a{k - 1}"])}]}}' for k in range(1, 8)]
    return written(folder, '\n'.join(['a0: &a0 {x: 1}', *layers]))


def alias_in_itself(folder):
    return written(folder, 'a: &a [*a]')


def deep_lists(folder):
    return written(folder, 400_000 * '[')


def deep_maps(folder):
    return written(folder, 150_000 * '{a: ')


def deep_blocks(folder):
    return written(folder, ''.join(' ' * k + 'a:\n' for k in range(1300)))


def python_tag(folder):
    return written(folder, 'schema: !!python/object/apply:os.system ["touch pwned"]')


def python_name(folder):
    return written(folder, 'schema: !!python/name:os.system ""')


def own_tag(folder):
    return written(folder, 'schema: !Vehicle {}')


def binary_tag(folder):
    return written(folder, 'schema: !!binary "////"')


def date_that_is_none(folder):
    return written(folder, 'schema: 2026-99-99')


def huge_integer(folder):
    return written(folder, 'schema: ' + 900_000 * '9')


def huge_hexadecimal(folder):
    return written(folder, 'schema: 0x' + 900_000 * 'f')


def sexagesimal(folder):
    return written(folder, 'schema: 1' + 300_000 * ':59')


def huge_exponent(folder):
    return written(folder, 'schema: 1.0e+999999999')


def not_utf8(folder):
    return written(folder, b'schema: \xff\xfe\x80')


def utf16(folder):
    return written(folder, 'schema: 1'.encode('utf-16'))


def nul(folder):
    return written(folder, b'schema: 3\0')


def escape_sequence(folder):
    return written(folder, 'schema: "\\e]0;owned\\a"\n"\\e[2J": 1\n')


def surrogate(folder):
    return written(folder, 'schema: "\\ud800"')


def too_large(folder):
    return written(folder, '# ' + 3_000_000 * 'x')


def key_twice(folder):
    return written(folder, 'schema: 1\nschema: 1')


def key_that_is_a_list(folder):
    return written(folder, '? [1, 2]\n: 1')


def many_documents(folder):
    return written(folder, 50_000 * '--- 1\n')


def empty(folder):
    return written(folder, '')


def nothing_but_a_word(folder):
    return written(folder, 'hello')


def infinity(folder):
    return changed(folder, 'schema: ', 'schema: .inf #')


def link_to_a_device(folder):
    (folder / 'hostile.yaml').symlink_to('/dev/zero')
    return folder / 'hostile.yaml'


def pipe(folder):
    import os

    os.mkfifo(folder / 'hostile.yaml')
    return folder / 'hostile.yaml'


def folder_for_a_file(folder):
    (folder / 'hostile.yaml').mkdir()
    return folder / 'hostile.yaml'


def link_in_a_circle(folder):
    (folder / 'hostile.yaml').symlink_to('hostile.yaml')
    return folder / 'hostile.yaml'


TEXTS = (
    bomb, merge_bomb, alias_in_itself, deep_lists, deep_maps, deep_blocks, python_tag, python_name,
    own_tag, binary_tag, date_that_is_none, huge_integer, huge_hexadecimal, sexagesimal,
    huge_exponent, not_utf8, utf16, nul, escape_sequence, surrogate, too_large, key_twice,
    key_that_is_a_list, many_documents, empty, nothing_but_a_word, infinity, link_to_a_device,
    pipe, folder_for_a_file, link_in_a_circle,
)  # fmt: skip
