#!/usr/bin/python3
"""Kills runs at random moments, resumes them, and compares what comes out with uninterrupted ones.

    campaign_kills.py [--seed N] [--kills N] [SCENARIO.yaml ...]

Each file is run on one to four ranks, or without a launcher; SIGKILL goes to one rank, to all, or
to mpirun, at a time from its start to a little after its end: while it is created, while sets are
estimated, between rounds, while it is resumed. Most are killed once, some up to four times, each
time on another number of ranks. After each kill what is marked done must be whole; the last run goes
to the end, and the file must be the same to the bit as the uninterrupted one. All choices follow
from the seed; where a kill strikes depends on the machine.
"""
import os
import random
import signal
import subprocess
import tempfile
import time

from campaign import Bad, STANCE, arguments, finish, main, must_be_same, references, run_line
import results_tools
from tap import PATIENCE


def children(process, living=False):
    """Ranks of an mpirun, by their process ids, as /proc has them; of those that live, if asked."""
    found = []
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", encoding="ascii", errors="replace") as stat:
                name, rest = stat.read().rsplit(")", 1)
            if int(rest.split()[1]) == process and name.endswith(
                    "(" + os.path.basename(STANCE)[:15]) and not (living and rest.split()[0] == "Z"):
                found.append(int(entry))
        except (OSError, ValueError, IndexError):
            pass
    return sorted(found)


def kill(process, mode, rng):
    """SIGKILL to a rank, all ranks, or the process that was started; False: nobody was there."""
    victims = [process.pid] if mode == "launcher" else children(process.pid)
    if mode == "rank" and victims:
        victims = [rng.choice(victims)]
    struck = process.poll() is None and bool(victims)
    for victim in victims:
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            struck = struck and len(victims) > 1
    return struck


def wait_for_end(process, ranks):
    """Of the launcher and of the ranks that it may have left behind. Open MPI 4.1's mpirun may wait for a lock of
    its own (PMIx_server_finalize) when all ranks have ended: then it is ended, too. Returns whether it was."""
    until, ended, stuck = time.monotonic() + PATIENCE, None, False
    while process.poll() is None:
        now = time.monotonic()
        ended = None if not ranks or children(process.pid, living=True) else ended or now
        if ended and now - ended > 120:
            stuck = True
            os.killpg(process.pid, signal.SIGKILL)
        elif now > until:
            left = children(process.pid)
            os.killpg(process.pid, signal.SIGKILL)
            raise Bad(f"the launcher does not end within {PATIENCE} s of a kill; of {len(ranks)} ranks "
                      f"{len(left)} are there")
        time.sleep(0.01)
    until = time.monotonic() + PATIENCE
    while any(os.path.exists(f"/proc/{rank}") for rank in ranks):
        if time.monotonic() > until:
            raise Bad("a rank outlives its launcher")
        time.sleep(0.01)
    return stuck


def run_and_kill(scenario, file, times, rng):
    """One run from where the file stands; returns whether the kill struck, and where."""
    ranks = rng.choice([0, 1, 2, 2, 3, 4])
    mode = rng.choice(["rank", "rank", "all", "launcher"]) if ranks else "launcher"
    when = rng.uniform(0, 1.05 * times[ranks])
    # Errors go to a file: the end of a pipe would come only with the end of all who hold it.
    with tempfile.TemporaryFile() as said, \
            subprocess.Popen(run_line(scenario, file, ranks, "--resume"),
                             stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said,
                             start_new_session=True) as process:
        time.sleep(when)
        alive = children(process.pid)
        struck = kill(process, mode, rng)
        try:
            stuck = wait_for_end(process, alive)
        except Bad as bad:
            raise Bad(f"{mode} of {ranks} after {when:.3f} s: {bad}") from bad
        said.seek(0)
        errors = said.read().decode(errors="replace")
    if not struck and process.returncode not in (0, 1) and not stuck:
        raise Bad(f"exit code {process.returncode}: {errors[-500:]}")
    if struck and ("damaged" in errors or "did not verify" in errors):
        raise Bad(f"damage is reported: {errors[-500:]}")
    return struck, f"{mode} of {ranks} after {when:.3f} s"


def marked(file):
    """Cases marked done, all of which must be whole; None without a file."""
    if not os.path.exists(file):
        return None
    try:
        return results_tools.whole(file, 0)[0]
    except AssertionError as wrong:
        raise Bad(str(wrong)) from wrong


def campaign(options, folder):
    """Yields each kill; returns the report."""
    good = references(options.scenarios, folder)
    file = os.path.join(folder, "killed.h5")
    kills = files = early = late = again = 0
    while kills < options.kills:
        rng = random.Random(f"{options.seed} {files}")
        scenario = options.scenarios[files % len(options.scenarios)]
        files += 1
        trace, struck_here, error = [], 0, None
        try:
            for _ in range(rng.choice([1, 1, 1, 2, 3, 4])):
                before = marked(file)
                struck, where = run_and_kill(scenario, file, good[scenario][1], rng)
                after = marked(file)
                trace.append(where)
                struck_here += struck
                late += not struck
                early += struck and not after
                if before is not None and (after is None or after < before):
                    raise Bad(f"{before} cases were done, now {after}")
            again += struck_here > 1
            _, _, errors = finish(run_line(scenario, file, rng.choice([0, 1, 2, 3, 4]), "--resume"),
                                  (0, 1))
            if "did not verify" in errors:
                raise Bad(errors)
            must_be_same(good[scenario][0], file)
            left = set(os.listdir(folder)) - {os.path.basename(g[0]) for g in good.values()}
            if left != {"killed.h5"}:
                raise Bad(f"left behind: {sorted(left)}")
        except Bad as bad:
            error = f"{os.path.basename(scenario)}: {'; '.join(trace)}: {bad}"
        kills += struck_here
        yield f"file{files}", error
        for name in os.listdir(folder):
            if name.startswith("killed"):
                os.remove(os.path.join(folder, name))
    return (f"{kills} kills of {files} files ({again} of them several times, {early} kills before "
            f"the first case was stored, {late} runs were quicker than their kill)")


if __name__ == "__main__":
    OPTIONS = arguments(__doc__, kills=200)
    main(campaign, OPTIONS)
