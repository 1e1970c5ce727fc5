"""
Memory: how far a run's peak lies above what was there before, against the arrays it returns.

Each run has a process of its own, as a peak is never forgotten.
"""

import json
import resource
import subprocess
import sys
from pathlib import Path

import runway_modal as rm
from _cases import SPEED, equal, irregular, modes
from _timing import line, machine, options

BAR = 3.0


def child(kind: str, segments: int) -> dict[str, int]:
    own, profile = modes(), {"equal": equal, "irregular": irregular}[kind](segments)
    rm.simulate(own, rm.Profile.full_mat(), SPEED)  # whatever a first call loads
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    before, earlier = pages * resource.getpagesize(), peak()
    response = rm.simulate(own, profile, SPEED)
    # What came before must not hide the run: its peak has to be the larger one.
    grown = peak() > earlier
    arrays = response.time.nbytes + response.modal.nbytes + response.modal_rate.nbytes
    return {"rows": response.time.size, "arrays": arrays, "extra": peak() - before, "grown": grown}


def peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def measure(segments: int) -> None:
    for kind in ("equal", "irregular"):
        command = [sys.executable, __file__, "--child", kind, str(segments)]
        answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        found = json.loads(answer)
        share = found["extra"] / found["arrays"]
        print(f"\n{segments:.0e} {kind} segments, {found['rows']} rows")
        line("time, modal and modal_rate", f"{found['arrays'] / 1e6:.1f} MB")
        line("peak of the run above what was there before", f"{found['extra'] / 1e6:.1f} MB")
        if not found["grown"]:
            line("hidden by an earlier peak", "")
        met = share < BAR and found["grown"]
        line("peak / arrays", f"{share:.2f}", f"< {BAR:g}", met)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        print(json.dumps(child(sys.argv[2], int(sys.argv[3]))))
    else:
        quick = options(__doc__)
        machine("runway_modal", "numpy")
        measure(50_000 if quick else 10_000_000)
