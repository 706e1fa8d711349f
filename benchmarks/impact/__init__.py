"""Impacts with known answers, and what superelements of few and many modes make of them."""
