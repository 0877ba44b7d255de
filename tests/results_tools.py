#!/usr/bin/python3
"""Looks into results files from outside, with h5py and numpy.

    results_tools.py same A B        every dataset outside `timing` is equal to the bit, and every
                                     attribute that is not provenance
    results_tools.py whole FILE [N]  every case marked done or failed has a right checksum, worked
                                     out here; at least N (default 1) are
    results_tools.py damage FILE I   changes one answer of the case with flat index I
    results_tools.py sealed FILE     every variable that is no answer, trajectory or time has a right
                                     checksum, worked out here
    results_tools.py flip FILE NAME COPY  copies the file with one bit changed in variable NAME, or
                                     in the text of attribute @NAME
"""
import sys

import h5py
import numpy

PROVENANCE = {"program_version", "git_revision", "compiler", "library_versions",
              "instruction_set", "ranks", "hosts", "date"}
# The answers in the order in which the checksum takes them.
ANSWERS = """outcome evidence failure end_time settle_time fall_time fall_cause steps iterations
    ambiguous_steps unranked_steps subdivided_steps degraded_samples max_penetration through_ground slip_distance footfalls walked_steps step_time step_length
    walking_speed cost_of_transport gait_period gait_change excursion peak_torque friction_used impact_friction least_normal_force
    impact_energy limited_impacts projection_energy events evaluations energy_gain energy_drift signorini_residual
    coulomb_residual dissipation_residual final_state scenario_number status""".split()


def contents(name):
    """Bits of every dataset outside `timing`, and of the attributes of the root."""
    found = {}

    def visit(path, node):
        if isinstance(node, h5py.Dataset) and not path.startswith("timing/"):
            # Text is kept as references into the file: take what they mean.
            text = h5py.check_string_dtype(node.dtype) is not None
            data = node[...]
            found[path] = (str(node.dtype), node.shape, data.tolist() if text else data.tobytes())

    with h5py.File(name, "r") as file:
        file.visititems(visit)
        for key, value in file.attrs.items():
            if key not in PROVENANCE:
                found["@" + key] = str(value)
    return found


def same(a, b):
    one, two = contents(a), contents(b)
    different = [k for k in sorted(one.keys() | two.keys()) if one.get(k) != two.get(k)]
    assert len(one) > 20, one.keys()
    assert not different, f"{a} and {b} differ in {different}"


def crc32c(rows):
    """CRC-32C of each row of a matrix of bytes, bit by bit from its definition."""
    table = numpy.arange(256, dtype=numpy.uint32)
    for _ in range(8):
        table = numpy.where(table & 1, table >> 1 ^ numpy.uint32(0x82F63B78), table >> 1)
    crc = numpy.full(len(rows), 0xFFFFFFFF, numpy.uint32)
    for column in rows.T:
        crc = table[(crc ^ column) & 0xFF] ^ crc >> numpy.uint32(8)
    return ~crc


def whole(name, least=1):
    with h5py.File(name, "r") as file:
        cases = file["status"].size
        parts = [numpy.frombuffer(file[v][...].tobytes(), numpy.uint8).reshape(cases, -1)
                 for v in ANSWERS if v in file]
        status = file["status"][...].ravel()
        wrong = crc32c(numpy.hstack(parts)) != file["checksum"][...].ravel()
    marked = status > 0
    assert set(status) <= {0, 1, 2}, set(status)
    assert not (wrong & marked).any(), f"{(wrong & marked).sum()} checksums are wrong"
    assert marked.sum() >= least, f"only {marked.sum()} of {cases} cases are marked"
    return int(marked.sum()), cases


def put_checksums(file):
    """Checksums that fit the answers of each case."""
    n = file["status"].shape
    parts = [numpy.frombuffer(file[name][...].tobytes(), numpy.uint8).reshape(file["status"].size, -1)
             for name in ANSWERS if name in file]
    file["checksum"][...] = crc32c(numpy.hstack(parts)).reshape(n)


def age(name, pending):
    """Makes of a finished file one of an earlier version, of which so many cases are pending: fewer
    answers, and counts of which 0 is what there is none of, as of cases that were inferred."""
    with h5py.File(name, "r+") as file:
        none = (file["evidence"][...] == 2) & numpy.isnan(file["end_time"][...])
        for answer in {"through_ground", "energy_drift", "walked_steps", "step_time", "step_length", "walking_speed", "cost_of_transport",
                       "gait_period", "gait_change", "impact_friction"} & set(file):
            del file[answer]
        for answer in ANSWERS:
            if answer in file and file[answer].dtype == numpy.int64:
                file[answer][...] = numpy.where(none, 0, file[answer][...])
                file[answer].attrs.modify("_FillValue", numpy.zeros(1, numpy.int64))
        put_checksums(file)
        status = file["status"][...]
        status.flat[:pending] = 0
        file["status"][...] = status


def damage(name, index):
    with h5py.File(name, "r+") as file:
        data = file["steps"][...]
        data.flat[index] += 1
        file["steps"][...] = data


def sealed(name):
    """The attribute `checksum` of axes, designs, names and instants."""
    rows = set(ANSWERS) | {"checksum"} | {
        "trajectory/" + v for v in ("position", "velocity", "torque", "force", "gap", "checksum")}
    found = 0

    def visit(path, node):
        nonlocal found
        if not isinstance(node, h5py.Dataset) or path in rows or path.startswith("timing/"):
            return
        if h5py.check_string_dtype(node.dtype) is not None:
            data = b"".join(word + b"\0" for word in node[...].ravel())
        else:
            data = node[...].astype("<f8" if node.dtype.kind == "f" else "<i8").tobytes()
        data = path.split("/")[-1].encode() + b"\0" + data
        crc = crc32c(numpy.frombuffer(data, numpy.uint8).reshape(1, -1))[0]
        assert node.attrs["checksum"] == [crc], path
        found += 1

    with h5py.File(name, "r") as file:
        file.visititems(visit)
    return found


def flip(name, variable, copy):
    """Changes a bit in the middle of the bytes of a variable or of an attribute's text."""
    with open(name, "rb") as file:
        data = bytearray(file.read())
    with h5py.File(name, "r") as file:
        if variable.startswith("@"):
            text = file.attrs[variable[1:]]
            text = text if isinstance(text, bytes) else text.encode()
            at = data.index(text) + len(text) // 2
        else:
            dataset = file[variable]
            at = dataset.id.get_offset() + dataset.id.get_storage_size() // 2
    data[at] ^= 1
    with open(copy, "wb") as file:
        file.write(data)


if __name__ == "__main__":
    task = sys.argv[1]
    if task == "same":
        same(sys.argv[2], sys.argv[3])
    elif task == "age":
        age(sys.argv[2], int(sys.argv[3]))
    elif task == "whole":
        print("# {} of {} cases are marked and whole".format(
            *whole(sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 1)))
    elif task == "sealed":
        print(f"# {sealed(sys.argv[2])} variables have right checksums")
    elif task == "flip":
        flip(*sys.argv[2:5])
    else:
        damage(sys.argv[2], int(sys.argv[3]))
