#!/usr/bin/python3
"""Makes network.txt: a network that begins as the linear law and recovers from more starts.

    train_network.py [STANCE [GENERATIONS [HIDDEN]]]

beside network.yaml, whose starts it learns from; network.c is trusted already. The first two hidden units
are the two rows of gains that `stance design` prints, over the largest torque that they are to ask for; the others
take no part yet. Then a separable CMA evolution strategy (Ros and Hansen, PPSN X, 2008, LNCS 5199, 296) varies all
weights: the networks of a generation stand in one file, and `controller.network`, swept, is which of them acts, so
that all are simulated by one run, from the same starts, others in each generation. The mean is what is kept, and
the best of the means by starts of their own is written.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

STANCE = sys.argv[1] if len(sys.argv) > 1 else "stance"
GENERATIONS = int(sys.argv[2]) if len(sys.argv) > 2 else 170
HIDDEN = int(sys.argv[3]) if len(sys.argv) > 3 else 8
HERE = Path(__file__).resolve().parent
UNIT = np.array([0.1, 0.2, 0.2, 0.5, 1, 1])  # rad, rad/s: half the box of the starts
MOST = 20.0  # N m
LINEAR = "{kind: state-feedback, design: place, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6], sample_time: 0.001}"
random = np.random.default_rng(1)
folder = Path(tempfile.mkdtemp())


def stance(*words):
    return subprocess.run([STANCE, *map(str, words)], check=True, capture_output=True, text=True).stdout


def write(path, networks):
    """All of them, one number a parameter: V and b of each hidden unit, then W over MOST."""
    with open(path, "w") as out:
        print("# train_network.py made this: inputs, hidden, outputs; units of the inputs; V and b; W", file=out)
        print("6", HIDDEN, "2\n" + " ".join(map(str, UNIT)), file=out)
        for network in networks:
            rows = np.split(network, [7 * HIDDEN])
            for row in [*rows[0].reshape(HIDDEN, 7), *(MOST * rows[1]).reshape(2, HIDDEN)]:
                print(*(f"{w:.6g}" for w in row), file=out)


def shares(networks, starts, seed):
    """Of each network the part of the starts that it recovers."""
    write(folder / "networks.txt", networks)
    grid = "sweep.grid=[{path: controller.network, from: 0, to: %d, count: %d}]" % (len(networks) - 1, len(networks))
    stance("run", HERE / "network.yaml", "--set", f"controller.data={folder / 'networks.txt'}", "--set", f"seed={seed}",
           "--set", grid, "--set", f"sweep.sample.count={starts}", "--quiet", "--force", "-o", folder / "n.h5")
    with h5py.File(folder / "n.h5") as file:
        words = file["outcome"].attrs["flag_meanings"]
        words = (words.decode() if isinstance(words, bytes) else words).split()
        return (file["outcome"][...] == words.index("stabilised")).reshape(len(networks), -1).mean(axis=1)


def first():
    design = json.loads(stance("design", HERE / "network.yaml", "--set", f"controller={LINEAR}", "--json"))
    gains = np.array(design["controller"]["gain"])
    hidden = np.zeros((HIDDEN, 7))
    hidden[:2, :6] = gains * UNIT / MOST
    hidden[2:] = random.normal(size=(HIDDEN - 2, 7)) / 2
    out = np.zeros((2, HIDDEN))
    out[0, 0] = out[1, 1] = -1
    return np.concatenate([hidden.ravel(), out.ravel()])


mean = first()
n, offspring, parents = len(mean), 24, 12
weight = np.log(parents + 0.5) - np.log(np.arange(1, parents + 1))
weight /= weight.sum()
mu = 1 / (weight**2).sum()
c_sigma, c_c = (mu + 2) / (n + mu + 5), 4 / (n + 4)
d_sigma = 1 + c_sigma + 2 * max(0, np.sqrt((mu - 1) / (n + 1)) - 1)
rank_mu = min(1, (2 * mu - 1) / ((n + 2) ** 2 + mu))
c_cov = min(1, (n + 2) / 3 * (2 / mu / (n + 2**0.5) ** 2 + (1 - 1 / mu) * rank_mu))
sigma, variance, path_sigma, path_c = 0.1, np.ones(n), np.zeros(n), np.zeros(n)
expected = np.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))
best_share = shares([mean], 4096, 0)[0]
print(f"first: {best_share:.3f}", flush=True)
for generation in range(1, GENERATIONS + 1):
    z = random.normal(size=(offspring, n))
    step = z * np.sqrt(variance)
    starts = 256 if generation < 160 else 512
    order = np.argsort(-shares(mean + sigma * step, starts, generation), kind="stable")[:parents]
    z, step = weight @ z[order], weight @ step[order]
    mean = mean + sigma * step
    path_sigma = (1 - c_sigma) * path_sigma + np.sqrt(c_sigma * (2 - c_sigma) * mu) * z
    path_c = (1 - c_c) * path_c + np.sqrt(c_c * (2 - c_c) * mu) * step
    variance = (1 - c_cov) * variance + c_cov / mu * path_c**2 + c_cov * (1 - 1 / mu) * step**2
    sigma *= np.exp(c_sigma / d_sigma * (np.linalg.norm(path_sigma) / expected - 1))
    if generation % 10 == 0:
        share = shares([mean], 4096, 0)[0]
        print(f"{generation}: {share:.3f}, sigma {sigma:.3g}", flush=True)
        if share > best_share:
            best_share = share
            write(HERE / "network.txt", [mean])
