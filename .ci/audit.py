"""Ask the vulnerability database about every pinned version; say so, and fail, where it was not asked.

pip-audit itself ends with 0 where the index does not know a package.  Exit codes: 0 every version was looked up and
none is known to be vulnerable; 1 some are; 75 (try again later) the database was not reached for every version.
"""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

PINS = Path(__file__).resolve().parents[1] / "constraints.txt"

NOT_RUN = 75


def verdict(document: dict[str, Any], pins: int) -> tuple[int, list[str]]:
    """Return the exit code for what pip-audit found of so many pins, and what to say."""
    packages = document.get("dependencies", [])
    bad = [f"{p['name']} {p['version']}: {', '.join(v['id'] for v in p['vulns'])}" for p in packages if p.get("vulns")]
    asked = sum(1 for p in packages if "skip_reason" not in p)
    if bad:
        return 1, ["vulnerable:", *bad]
    if asked < pins:
        return NOT_RUN, [f"NOT AUDITED: {pins - asked} of {pins} versions could not be looked up"]
    return 0, [f"{asked} versions looked up, none is known to be vulnerable"]


def main() -> int:
    """Run pip-audit of this interpreter's environment over constraints.txt."""
    pins = [line for line in PINS.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    command = [sys.executable, "-m", "pip_audit", "--requirement", str(PINS), "--no-deps", "--disable-pip"]
    done = subprocess.run([*command, "--format", "json"], capture_output=True, text=True, check=False)  # noqa: S603
    try:
        code, lines = verdict(json.loads(done.stdout), len(pins))
    except ValueError:
        last = (done.stderr.strip().splitlines() or ["no answer"])[-1]
        code, lines = NOT_RUN, [f"NOT AUDITED: pip-audit gave no answer: {last[:300]}"]
    print("\n".join(f"audit: {line}" for line in lines))
    return code


if __name__ == "__main__":
    sys.exit(main())
