"""What is said of the project in files for others is what the project is."""

import re
import subprocess
import sys
import tomllib

import pytest
import yaml
from import_order import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
TARGETS = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.M))


def test_the_citation_has_the_version_and_the_license():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert (cited["version"], cited["license"]) == (PROJECT["version"], PROJECT["license"])


def test_the_changelog_has_a_section_of_the_version_below_the_unreleased_one():
    headings = re.findall(r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text(), flags=re.M)
    assert headings[:2] == ["Unreleased", PROJECT["version"]]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_call_targets_that_there_are_and_hold_no_secrets(path):
    text = path.read_text()
    workflow = yaml.safe_load(text)
    assert "secrets" not in text
    assert workflow["permissions"] == {"contents": "read"}
    called = set(re.findall(r"\bmake ([a-z-]+)", text))
    assert called <= TARGETS
    actions = re.findall(r"uses: ([^.\s]\S*)", text)
    assert all(re.fullmatch(r"[\w-]+/[\w-]+@v\d+(\.\d+\.\d+)?", action) for action in actions)


def test_a_release_is_published_after_all_tests():
    jobs = yaml.safe_load((ROOT / ".github/workflows/release.yml").read_text())["jobs"]
    assert set(jobs["publish"]["needs"]) == {"tests", "build"}
    called = yaml.safe_load((ROOT / jobs["tests"]["uses"]).read_text())
    # YAML takes the key `on` for a truth value.
    assert "workflow_call" in called[True]


@pytest.mark.parametrize(("variables", "code"), [({}, 0), ({"CI": "true"}, 1)])
def test_a_site_that_nobody_looked_at_fails_in_ci(tmp_path, variables, code):
    command = [sys.executable, ROOT / "tools/check_site.py", tmp_path]
    done = subprocess.run(command, env={"PATH": "", **variables}, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (code, "no Chromium: the site was not looked at\n")


def test_hooks_are_local_and_their_scripts_exist():
    (repository,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    assert repository["repo"] == "local"
    words = " ".join(hook["entry"] for hook in repository["hooks"]).split()
    assert all((ROOT / word).exists() for word in words if word.endswith(".py"))


@pytest.mark.parametrize("path", sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")))
def test_templates_of_issues_have_fields_with_different_names(path):
    template = yaml.safe_load(path.read_text())
    names = [field["id"] for field in template["body"] if "id" in field]
    assert names
    assert len(set(names)) == len(names)


def test_versions_of_files_on_the_page_of_compatibility_are_those_that_are_written():
    from duhamel.cli.call import RECORD_VERSION
    from duhamel.cli.installation import REPORT_VERSION
    from duhamel.results.contents import EARLIEST_VERSION, RESULTS_VERSION
    from duhamel.solver.checkpoint.file import STATE_VERSION
    from duhamel.superelement.file import SUPERELEMENT_VERSION

    text = (ROOT / "docs" / "compatibility.md").read_text()
    assert f"| superelement (HDF5) | {SUPERELEMENT_VERSION} | 1 to {SUPERELEMENT_VERSION} |" in text
    versions = f"{RESULTS_VERSION} | {EARLIEST_VERSION} to {RESULTS_VERSION}"
    assert f"| results (netCDF-4) | {versions} |" in text
    assert re.search(rf"\| state of a run.* \| {STATE_VERSION} \|", text)
    assert f"| record in JSON | {RECORD_VERSION} |" in text
    assert f"| bug report | {REPORT_VERSION} |" in text
