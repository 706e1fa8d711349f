"""Known vulnerabilities of pinned versions, by pip-audit; a word, where its list is out of reach.

python .ci/audit.py constraints.txt
"""

import json
import subprocess
import sys
from typing import Any

COMMAND = ["pip_audit", "--disable-pip", "--require-hashes", "--progress-spinner=off", "-f=json"]


def audited(constraints: str) -> list[dict[str, Any]] | None:
    """What pip-audit says of each version; None where it can ask nobody."""
    done = subprocess.run(
        [sys.executable, "-m", *COMMAND, "-r", constraints], capture_output=True, text=True
    )
    try:
        versions = json.loads(done.stdout)["dependencies"]
    except ValueError:
        if any(word in done.stderr for word in ("ConnectionError", "SSLError")):
            return None
        sys.exit(f"pip-audit {constraints}: {done.stderr}")
    # A mirror that has files but no list of vulnerabilities answers that it knows no version.
    return versions if any("skip_reason" not in version for version in versions) else None


def main(constraints: str) -> None:
    versions = audited(constraints)
    if versions is None:
        print(f"pip-audit {constraints}: not reached: no list of vulnerabilities, nothing is known")
        return
    for version in versions:
        for found in version.get("vulns", ()):
            print(f"{version['name']} {version['version']}: {found['id']}")
    skipped = sum("skip_reason" in version for version in versions)
    print(f"pip-audit {constraints}: {len(versions) - skipped} versions asked, {skipped} unknown")
    if any(version.get("vulns") for version in versions):
        sys.exit(1)


if __name__ == "__main__":
    main(*sys.argv[1:])
