"""Tables in HTML, as notebooks show them."""

from duhamel.files.html import MAX_HTML_VALUE, listed, table


def test_what_is_in_a_table_is_text():
    shown = table("<script>alert(1)</script>", [("a & b", "x < y\nz")])
    assert "<script>" not in shown
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in shown
    assert "a &amp; b" in shown
    assert "x &lt; y<br>z" in shown


def test_a_long_value_is_cut():
    assert "x" * (MAX_HTML_VALUE + 1) not in table("t", [("a", "x" * (2 * MAX_HTML_VALUE))])


def test_many_names_are_listed_in_part():
    assert listed("abc", most=2) == "a, b and 1 more"
    assert listed("ab", most=2) == "a, b"
    assert listed(()) == "none"
