"""What a user says of a mechanism and how to integrate it."""
