"""The `duhamel` command."""
