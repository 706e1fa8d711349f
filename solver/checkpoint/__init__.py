"""The state of a run: copies in memory, files, and what they belong to."""
