#!/usr/bin/python3
"""Damages results files and looks whether anybody is fooled.

    campaign_damage.py [--seed N] [--truncations N] [--flips N] [SCENARIO.yaml ...]

Finished files and half-finished ones are cut short (to nothing, by some bytes, anywhere) or have one
bit turned over (anywhere, one in three within what is not answers). Then
  status, summary, plot, compare  end with exit code 0 or 3 (compare: not 0 unless nothing that it
                                  looks at changed), without a crash; errors are one line;
                                  the summary is that of the undamaged file, or says what it
                                  leaves out;
  run --resume                    refuses with one line, or ends with the very file that an
                                  uninterrupted run makes.
All choices follow from the seed.
"""
import json
import os
import random
import shutil

import h5py

from campaign import Bad, STANCE, arguments, finish, main, must_be_same, references, run_line


def half_finished(scenario, good, file, rng):
    """A copy in which some stretches of cases are pending, as a killed run leaves them."""
    shutil.copy(good, file)
    with h5py.File(file, "r+") as h5:
        status = h5["status"][...].ravel()
        for _ in range(3):
            first = rng.randrange(status.size)
            status[first:first + status.size // 4] = 0
        h5["status"][...] = status.reshape(h5["status"].shape)
    return scenario, good, file


def outside_answers(file):
    """Byte ranges of the file that hold no variable over the cases."""
    taken = []
    with h5py.File(file, "r") as h5:
        def visit(_, node):
            if isinstance(node, h5py.Dataset) and node.id.get_storage_size() > 4096:
                offset = node.id.get_offset()
                if offset is not None:
                    taken.append((offset, offset + node.id.get_storage_size()))
        h5.visititems(visit)
    free, at = [], 0
    for begin, end in sorted(taken):
        if begin > at:
            free.append((at, begin))
        at = max(at, end)
    size = os.path.getsize(file)
    if size > at:
        free.append((at, size))
    return free


def truncate(file, rng):
    """Cuts the file; returns what was done."""
    size = os.path.getsize(file)
    kind = rng.choice(["nothing", "bytes", "anywhere", "anywhere", "head"])
    length = {"nothing": 0, "bytes": size - rng.randint(1, 64), "anywhere": rng.randrange(size),
              "head": rng.randrange(min(size, 65536))}[kind]
    os.truncate(file, length)
    return f"cut to {length} of {size} bytes"


def flip(file, rng):
    """Turns one bit over; returns what was done."""
    if rng.random() < 1 / 3:
        ranges = outside_answers(file)
        at = rng.randrange(sum(end - begin for begin, end in ranges))
        for begin, end in ranges:
            if at < end - begin:
                at += begin
                break
            at -= end - begin
    else:
        at = rng.randrange(os.path.getsize(file))
    bit = rng.randrange(8)
    with open(file, "r+b") as raw:
        raw.seek(at)
        byte = raw.read(1)[0]
        raw.seek(at)
        raw.write(bytes([byte ^ 1 << bit]))
    return f"bit {bit} of byte {at} turned"


def one_line(errors, what):
    """An error is one line."""
    if errors.count("\n") != 1:
        raise Bad(f"{what} says {errors!r}")


def summary_of(file):
    """What summary says without what may differ; None when it refuses."""
    code, output, errors = finish([STANCE, "summary", "--json", file], (0, 3))
    if code == 3:
        one_line(errors, "summary")
        return None, errors
    summary = json.loads(output)
    for key in ("cost", "file"):
        summary.pop(key)
    return summary, errors


def only_fewer(found, expected):
    """Nothing but cases that count as pending: what the summary is about, less some cases."""
    one, two = found["cases"], expected["cases"]
    return one["total"] == two["total"] and one["pending"] > two["pending"]


def look(file, good, expected, pictures):
    """All commands that read. Returns whether any of them saw the damage."""
    seen = False
    for command in [["status"], ["status", "--json"]] + ([["plot", "-o", "pictures"]] * pictures):
        code, _, errors = finish([STANCE, command[0], file, *command[1:]], (0, 3))
        if code:
            seen = True
            one_line(errors, command[0])
    summary, errors = summary_of(file)
    seen = seen or summary is None or "not verify" in errors
    if summary is not None and summary != expected:
        damaged = summary["cases"]["damaged"]
        if not only_fewer(summary, expected) or (damaged > 0) != ("not verify" in errors):
            raise Bad("the summary differs and does not say why")
        seen = True
    code, _, errors = finish([STANCE, "compare", good, file], (0, 1, 3))
    if code == 3 and not errors:
        raise Bad("compare refuses without a word")
    return seen or code > 0


def resume(scenario, good, file, ranks):
    """Returns whether it was refused; what it finishes must be the good file."""
    code, _, errors = finish(run_line(scenario, file, ranks, "--resume"), (0, 1, 3))
    if code == 3:
        lines = [line for line in errors.splitlines() if line.startswith("stance") or file in line]
        if len(lines) != 1:
            raise Bad(f"a refusal of {len(lines)} lines: {errors!r}")
        return True, False
    must_be_same(good, file)
    return False, "did not verify" in errors


def campaign(options, folder):
    """Yields each damage; returns the report."""
    scenarios = [os.path.abspath(s) for s in options.scenarios]
    os.chdir(folder)
    rng = random.Random(f"damage {options.seed}")
    victims = []
    for scenario, (good, _) in references(scenarios, folder).items():
        half = os.path.join(folder, "half-" + os.path.basename(good)[5:])
        victims += [(scenario, good, good), half_finished(scenario, good, half, rng)]
    expected = {victim[2]: summary_of(victim[2])[0] for victim in victims}
    file = os.path.join(folder, "damaged.h5")
    found = {"refused": 0, "computed again": 0, "harmless": 0}
    total = options.truncations + options.flips
    for k in range(total):
        rng = random.Random(f"{options.seed} {k}")
        scenario, good, victim = victims[k % len(victims)]
        shutil.copy(victim, file)
        damage = (truncate if k < options.truncations else flip)(file, rng)
        error = None
        try:
            seen = look(file, good, expected[victim], k % 4 == 0)
            refused, again = resume(scenario, good, file, rng.choice([0, 0, 2]))
            if k < options.truncations and not (refused and seen):
                raise Bad("a truncation that is not seen")
            found["refused" if refused else "computed again" if again else "harmless"] += 1
        except Bad as bad:
            error = f"{os.path.basename(victim)}, {damage}: {bad}"
        yield f"damage{k}", error
        os.remove(file)
    return (f"{options.truncations} truncations, {options.flips} turned bits: "
            + ", ".join(f"{count} {what}" for what, count in found.items()))


if __name__ == "__main__":
    main(campaign, arguments(__doc__, truncations=50, flips=200))
