#!/bin/sh
# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
# Build docs/ as a site in site/, strictly: a link that leads nowhere is an error.
#
# MkDocs has an environment of its own, .venv-docs: nothing that flies or tests needs it.
set -eu
cd "$(dirname "$0")/.."
venv=.venv-docs

wanted=$({
    .venv/bin/python -V
    cat locked/docs.txt tools/site.sh
} | sha256sum | cut -d ' ' -f 1)
if [ "$(cat "$venv/.lta" 2>/dev/null || :)" != "$wanted" ]; then
    echo "docs: MkDocs in $venv (first time: half a minute) ..."
    rm -rf "$venv"
    .venv/bin/python -P -m venv "$venv"
    if ! "$venv/bin/python" -P -m pip install --disable-pip-version-check --no-input \
        --require-hashes --requirement locked/docs.txt \
        >"$venv/install.log" 2>&1; then
        echo "pip cannot install MkDocs (see $venv/install.log); check the network and run" \
            'make docs again.' >&2
        exit 2
    fi
    : >"$venv/COLCON_IGNORE"
    echo "$wanted" >"$venv/.lta"
fi
NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict --quiet --clean
echo "The site: $PWD/site/index.html"
echo "With search: python3 -m http.server --bind 127.0.0.1 --directory site"
