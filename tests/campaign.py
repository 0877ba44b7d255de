"""What the campaigns share: scenarios, runs that must end, and what a good file is."""
import argparse
import glob
import os
import subprocess
import sys
import tempfile
import time

import results_tools
from tap import PATIENCE

HERE = os.path.dirname(os.path.abspath(__file__))
STANCE = os.environ.get("STANCE") or os.path.join(HERE, "..", "bin", "stance")

os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                  OMPI_MCA_btl_vader_single_copy_mechanism="none", PMIX_MCA_gds="hash",
                  OMPI_MCA_rmaps_base_oversubscribe="1")


class Bad(Exception):
    """What must not happen."""


def arguments(text, **counts):
    """Options of a campaign: --seed, --keep, its counts, and a list of scenario files."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("scenarios", nargs="*",
                        default=sorted(glob.glob(os.path.join(HERE, "campaign", "*.yaml"))))
    parser.add_argument("--seed", type=int, default=1, help="another one, another campaign")
    parser.add_argument("--keep", help="folder for the files of what failed")
    for name, count in counts.items():
        parser.add_argument("--" + name, type=int, default=count)
    return parser.parse_args()


def run_line(scenario, file, ranks, *options):
    """The command that runs a scenario; no ranks: without a launcher."""
    launch = ["mpirun", "-n", str(ranks)] if ranks else []
    return launch + [STANCE, "run", scenario, "-o", file, "--quiet", *options]


def finish(line, codes):
    """Runs a command to its end; returns exit code, output and errors."""
    try:
        done = subprocess.run(line, capture_output=True, timeout=PATIENCE, check=False,
                              stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired as late:
        raise Bad(f"hangs: {' '.join(line)}") from late
    errors = done.stderr.decode(errors="replace")
    if done.returncode not in codes:
        raise Bad(f"exit code {done.returncode} of {' '.join(line)}: {errors[-500:]}")
    return done.returncode, done.stdout.decode(errors="replace"), errors


def references(scenarios, folder):
    """Each scenario's good file and how long it takes on 0, 1 ... 4 ranks, in s."""
    good = {}
    for scenario in scenarios:
        name = os.path.splitext(os.path.basename(scenario))[0]
        file = os.path.join(folder, "good-" + name + ".h5")
        times = []
        for ranks in range(5):
            begin = time.monotonic()
            finish(run_line(scenario, file, ranks, "--force"), (0, 1))
            times.append(time.monotonic() - begin)
        good[scenario] = (file, times)
    return good


def must_be_same(good, file):
    """By `stance compare` and by h5py."""
    finish([STANCE, "compare", good, file], (0,))
    try:
        results_tools.same(good, file)
    except (AssertionError, OSError, RuntimeError, KeyError) as different:
        raise Bad(f"{type(different).__name__}: {different}") from different


def main(campaign, options):
    """Runs campaign(options, folder), which yields (name, error or None) and returns its report."""
    bad = count = 0
    with tempfile.TemporaryDirectory() as folder:
        steps = campaign(options, folder)
        try:
            while True:
                name, error = next(steps)
                count += 1
                if count % 50 == 0:
                    print(f"# {name}, {bad} bad so far", file=sys.stderr, flush=True)
                if error:
                    bad += 1
                    print(f"# {name}: {error}", flush=True)
                    if options.keep:
                        subprocess.run(["cp", "-r", folder, os.path.join(options.keep, name)],
                                       check=False)
        except StopIteration as end:
            print(f"{'not ok' if bad else 'ok'} - {end.value}, {bad} bad", flush=True)
    sys.exit(bad > 0)
