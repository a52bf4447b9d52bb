# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Export recordings as Parquet, CSV or MATLAB files."""
