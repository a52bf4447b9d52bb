"""Export recordings as Parquet, CSV or MATLAB files."""
