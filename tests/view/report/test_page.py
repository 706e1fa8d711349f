"""The page of a report as a file."""

from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from duhamel import solver, view
from duhamel.results import Results
from duhamel.view.report import libraries, markup, page, tables
from duhamel.view.report.head import judged

from .conftest import EVIL, MODEL


class Parsed(HTMLParser):
    """Elements with their attributes, and the text outside scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.text, self._inside = [], "", []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self._inside.append(tag)

    def handle_endtag(self, tag):
        while self._inside and self._inside.pop() != tag:
            pass

    def handle_data(self, data):
        if not {"script", "style"} & set(self._inside):
            self.text += data


@pytest.fixture(scope="module")
def parsed(page_file):
    return Parsed(page_file.read_text(encoding="utf-8"))


def test_the_parts_that_are_made_are_told_up_to_all_of_them(results, tmp_path):
    told = []
    view.write_report(results, tmp_path / "x.html", on_part=lambda *numbers: told.append(numbers))
    total = len(results.bodies) + page.PARTS_BESIDE_BODIES
    assert told == [(n, total) for n in range(1, total + 1)]


def test_no_element_names_an_address_outside_the_page(parsed):
    addresses = [
        value
        for _, attributes in parsed.elements
        for name, value in attributes.items()
        if name in ("src", "href", "srcset", "action", "data", "poster", "background")
    ]
    assert addresses
    assert all(address.startswith(("data:", "#")) for address in addresses)


def test_styles_load_nothing():
    style = markup.read("page.css")
    assert "url(" not in style
    assert "@import" not in style


def test_names_and_the_text_of_the_model_stay_text(parsed):
    scripts = [attributes for tag, attributes in parsed.elements if tag == "script"]
    assert [a.get("id") for a in scripts] == ["plotly", "k3d", "scene", "data", None]
    assert f"force:{EVIL}" in parsed.text
    assert MODEL in parsed.text
    assert "A beam on a hub </script></style></title></pre> & more." in parsed.text


def test_no_attribute_handles_events(parsed):
    names = {name for _, attributes in parsed.elements for name in attributes}
    assert not [name for name in names if name.startswith("on")]


def test_every_link_leads_to_a_part_of_the_page(parsed):
    identities = {attributes.get("id") for _, attributes in parsed.elements}
    links = [a["href"] for tag, a in parsed.elements if tag == "a"]
    assert len(links) > 8
    assert all(link.removeprefix("#") in identities for link in links)


def test_a_page_is_far_below_fifteen_megabytes(page_file):
    assert page_file.stat().st_size < 5e6


def test_tables_have_the_numbers_of_the_results(parsed, results):
    (event,) = [e for e in results.events.values() if len(e)]
    assert f"{event.peak[0]:.4g} N m" in parsed.text
    assert f"{results.momentum.linear[-1][0]:.4g}" in parsed.text
    assert results.superelement_files["beam"].digest in parsed.text


def test_a_passed_limit_stands_at_the_top_with_its_name(results, monkeypatch):
    name = "elastic_rotation:beam.tip"
    checks = type(results.validity)((type(results.validity.checks[0]).of(name, 0.5),))
    monkeypatch.setattr(Results, "validity", property(lambda self: checks))
    told = markup.part("verdict", *judged(results))
    assert 'class="verdict poor"' in told
    assert "beam.tip" in told
    assert "elastic rotation: 0.5 rad (limit &lt; 0.3 rad)" in told


def test_the_banner_says_what_exceeds_and_how_much_holds(results, monkeypatch):
    of = type(results.validity.checks[0]).of
    checks = type(results.validity)((of("elastic_rotation:beam.tip", 0.5), of("spin:beam", 0.01)))
    monkeypatch.setattr(Results, "validity", property(lambda self: checks))
    _, text, _ = judged(results)
    exceeded = "elastic rotation of beam.tip: 0.5 rad (limit < 0.3 rad)"
    assert text == f"Exceeded: {exceeded}. 1 of 2 criteria hold."
    assert "✗ Beyond its limits" in markup.part("verdict", *judged(results))


def test_a_run_within_all_limits_says_so(results, monkeypatch):
    checks = type(results.validity)((type(results.validity.checks[0]).of("spin:beam", 0.01),))
    monkeypatch.setattr(Results, "validity", property(lambda self: checks))
    kind, text, warnings = judged(results)
    assert (kind, warnings) == ("good", [])
    assert "All validity limits respected" in text


def test_the_page_is_not_written_over_the_results(results, run_file, tmp_path):
    link = tmp_path / "link.html"
    link.symlink_to(run_file)
    before = run_file.read_bytes()
    with pytest.raises(view.PictureError, match=r"link\.html is the results file"):
        view.write_report(results, link)
    assert run_file.read_bytes() == before


def test_the_page_is_not_written_over_a_superelement(results, beam_file, tmp_path):
    link = tmp_path / "link.html"
    link.symlink_to(beam_file)
    with pytest.raises(view.PictureError, match="is a superelement, which the report"):
        view.write_report(results, link)


@pytest.mark.parametrize(
    ("name", "told"), [("none/x.html", "no folder"), ("x.png", "expected a suffix of .html")]
)
def test_where_no_page_can_be_written_is_told_in_one_line(results, tmp_path, name, told):
    with pytest.raises(view.PictureError, match=told):
        view.write_report(results, tmp_path / name)


def test_a_page_that_fails_leaves_the_old_one(results, tmp_path, monkeypatch):
    old = tmp_path / "x.html"
    old.write_text("old")
    monkeypatch.setattr("duhamel.view.report.write.page", lambda *given: "new")
    monkeypatch.setattr(Path, "write_text", _full)
    with pytest.raises(view.PictureError, match=r"x\.html: cannot be written: no space"):
        view.write_report(results, old)
    assert [entry.name for entry in tmp_path.iterdir()] == ["x.html"]
    assert old.read_bytes() == b"old"


def _full(self, *given, **more):
    raise OSError("no space")


def test_without_its_packages_one_line_says_what_to_install(results, tmp_path, monkeypatch):
    def missing(name):
        raise ImportError(f"No module named {name!r}")

    monkeypatch.setattr(libraries, "import_module", missing)
    with pytest.raises(view.PictureError, match=r"needs plotly: pip install 'duhamel\[report\]'"):
        view.write_report(results, tmp_path / "x.html")


def test_a_run_that_recorded_one_number_has_a_page_that_says_what_is_missing(beam_file, tmp_path):
    text = MODEL + '\n[output]\nquantities = ["momentum"]\nevery = 50\n'
    beam_file.with_name("few.toml").write_text(text)
    few = solver.simulate(solver.read_model(beam_file.with_name("few.toml")))
    view.write_report(few, tmp_path / "few.html")
    text = Parsed((tmp_path / "few.html").read_text(encoding="utf-8")).text
    assert "No animation: the run recorded no body." in text
    assert "No energy balance: the run did not record energies." in text
    assert "results in memory" in text


def test_a_table_of_many_rows_says_that_it_ends_early():
    rows = [(str(i),) for i in range(tables.MAX_TABLE_ROWS + 1)]
    shown = Parsed(tables._limited(("n",), rows)).text
    assert f"The first {tables.MAX_TABLE_ROWS} of {tables.MAX_TABLE_ROWS + 1} rows." in shown


def test_numbers_that_are_none_are_dashes(results):
    assert "nan" not in tables.events_table(results)
    assert tables.short(float(np.nan)) == "–"
