"""Results: typed records of all summaries, numbers in words, tables, and atomic files."""
