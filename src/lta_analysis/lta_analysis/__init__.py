"""What we learn: bag tables, reports and the lta command."""
