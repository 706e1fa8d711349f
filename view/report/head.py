"""The head of a report: what was run, and how far it can be trusted."""

from collections.abc import Iterator

from ...results import Results
from ...results.validity import MAX_SHOWN_WARNINGS, Validity
from ..prefixes import seconds
from .numbers import counted
from .origin import Origin, opening


def head(results: Results, origin: Origin) -> dict[str, object]:
    """What the template of the page says of a run above its sections."""
    kind, text, warnings = judged(results)
    return {
        "kind": kind,
        "text": text,
        "warnings": warnings,
        "sentence": sentence(results),
        "about": opening(results.model),
        "facts": list(_facts(results, origin)),
    }


def judged(results: Results) -> tuple[str, str, list[str]]:
    """ "good", "fair" or "poor", what holds and what exceeds, and a line for each limit passed."""
    checks, text = results.validity.checks, standing(results.validity)
    if unfinished := not results.solver.get("finished", True):
        text = f"The run did not come to its end: what follows is as far as it got. {text}"
    verdicts = [check.verdict for check in checks]
    if poor := verdicts.count("poor"):
        warnings = list(results.validity.warnings[:MAX_SHOWN_WARNINGS])
        if poor > MAX_SHOWN_WARNINGS:
            warnings.append(f"and {poor - MAX_SHOWN_WARNINGS} more: see the table of validity")
        return "poor", text, warnings
    good = "good" in verdicts and "fair" not in verdicts and not unfinished
    return "good" if good else "fair", text, []


def standing(validity: Validity) -> str:
    """One line: which criteria exceed their limits and how many hold, or the usual summary."""
    worst = [check for check in validity.worst if check.verdict != "unknown"]
    poor = [check for check in worst if check.verdict == "poor"]
    if not poor:
        return validity.summary
    exceeding = "; ".join(check.beyond for check in poor)
    return f"Exceeded: {exceeding}. {len(worst) - len(poor)} of {len(worst)} criteria hold."


def sentence(results: Results) -> str:
    """One sentence: bodies, joints, degrees of freedom, duration and steps."""
    solver, time = results.solver, results.time
    flexible = len(results.superelement_files)
    parts = [counted(len(results.bodies), "body", "bodies") + f" recorded ({flexible} flexible)"]
    for names, noun in (
        (results.joints, "joint"),
        (results.springs, "spring"),
        (results.contacts, "contact"),
        (results.surface_contacts, "surface contact"),
        (results.stops, "stop"),
        (results.motors, "motor"),
        (results.couplers, "coupler"),
    ):
        if names:
            parts.append(counted(len(names), noun))
    if "degrees_of_freedom" in solver:
        dofs = int(solver["degrees_of_freedom"])
        parts.append(f"{counted(dofs, 'degree')} of freedom with all bodies rigid")
    duration = f"{seconds(float(time[-1] - time[0]))} of motion" if len(time) else "no steps"
    steps = f" in {counted(int(solver['steps']), 'step')}" if "steps" in solver else ""
    length = f" of {seconds(float(solver['h']))}" if "h" in solver else ""
    return f"{', '.join(parts)}; {duration}{steps}{length}."


def _facts(results: Results, origin: Origin) -> Iterator[tuple[str, str]]:
    from importlib.metadata import version

    written = origin.written.strftime("%Y-%m-%d %H:%M %Z") if origin.written else ""
    yield "Results", str(origin.path) if origin.path else "in memory"
    yield "Written", written
    yield "Run by", origin.created_by
    yield "Reported by", f"duhamel {version('duhamel')}"
