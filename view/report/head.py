"""The head of a report: what was run, and how far it can be trusted."""

from ...results import Results
from ...results.validity import MAX_SHOWN_WARNINGS
from .markup import Markup, element, facts, joined
from .numbers import counted, seconds
from .origin import Origin, opening


def head(results: Results, origin: Origin, title: str) -> Markup:
    """Title, verdict, summary."""
    about = opening(results.model)
    return element(
        "header",
        element("h1", title),
        verdict(results),
        element("p", sentence(results)),
        element("p", about, class_="about") if about else "",
        facts(_facts(results, origin)),
    )


def verdict(results: Results) -> Markup:
    """Whether a limit was exceeded, with the names of what exceeds it."""
    checks = results.validity.checks
    poor = [check for check in checks if check.verdict == "poor"]
    if not results.solver.get("finished", True):
        unfinished = "The run did not come to its end: what follows is as far as it got. "
    else:
        unfinished = ""
    if poor:
        lines = [element("li", line) for line in results.validity.warnings[:MAX_SHOWN_WARNINGS]]
        if len(poor) > MAX_SHOWN_WARNINGS:
            lines.append(
                element(
                    "li", f"and {len(poor) - MAX_SHOWN_WARNINGS} more: see the table of validity"
                )
            )
        text = f"{unfinished}{results.validity.summary}"
        return element("div", element("strong", text), element("ul", *lines), class_="verdict poor")
    verdicts = {check.verdict for check in checks}
    good = "good" in verdicts and "fair" not in verdicts and not unfinished
    text = unfinished + results.validity.summary
    return element("div", text, class_=f"verdict {'good' if good else 'fair'}")


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


def _facts(results: Results, origin: Origin) -> list[tuple[str, object]]:
    from importlib.metadata import version

    written = origin.written.strftime("%Y-%m-%d %H:%M %Z") if origin.written else ""
    return [
        ("Results", str(origin.path) if origin.path else "in memory"),
        ("Written", written),
        ("Run by", origin.created_by),
        ("Reported by", f"duhamel {version('duhamel')}"),
    ]


def contents(parts: list[tuple[str, str]]) -> Markup:
    """Links to the parts of the page, by identity and heading."""
    links = [element("a", heading, href=f"#{identity}") for identity, heading in parts]
    return element("nav", joined(links))
