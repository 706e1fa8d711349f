"""The body file: what a user says of a part."""
