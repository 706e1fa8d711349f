"""The bracket that superelements are made of, and how they are measured."""
