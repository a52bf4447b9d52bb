"""Recordings as files of other programs: Parquet, CSV, MATLAB."""
