#!/usr/bin/python3
"""What builds stance elsewhere names what the Makefile and the runner's page name: the image's recipe
(runner/install/Containerfile) and Spack's (runner/install/spack). Speaks TAP."""
import pathlib
import re
import subprocess
import sys
import types

from tap import tap

TOP = pathlib.Path(__file__).resolve().parent.parent
INSTALL = TOP / "runner/install"
# A Debian package, and Spack's of the same library.
SPACK = {"libopenmpi-dev": "openmpi", "libhdf5-openmpi-dev": "hdf5", "libyaml-dev": "libyaml",
         "liblapacke-dev": "netlib-lapack", "libslicot-dev": "slicot", "libsundials-dev": "sundials",
         "libgsl-dev": "gsl", "librandom123-dev": "random123", "libjansson-dev": "jansson",
         "libssl-dev": "openssl", "zlib1g-dev": "zlib-api", "libxml2-dev": "libxml2",
         "gnuplot-nox": "gnuplot"}
# Spack has them in others, or leaves them to the system, or the program does without.
WITH_OTHERS = {"openmpi-bin", "fonts-dejavu-core", "libmujoco-dev"}


def makefile(name):
    """Words of a variable of the Makefile."""
    text = (TOP / "Makefile").read_text(encoding="utf-8").replace("\\\n", " ")
    return re.search(rf"(?m)^{name}\s*[:?]?=(.*)$", text)[1].split()


def instructions(kind):
    """Those of the image's recipe that begin so, without that word."""
    text = (INSTALL / "Containerfile").read_text(encoding="utf-8").replace("\\\n", " ")
    return re.findall(rf"(?m)^{kind} (.*)$", text)


def load(name):
    """A recipe of Spack's, run with what it may use: its class and what it called."""
    called = []

    def note(kind):
        return lambda *words, **options: called.append((kind, words, options))
    stub = types.ModuleType("spack.package")
    for kind in "license", "version", "variant", "depends_on":
        setattr(stub, kind, note(kind))
    stub.MakefilePackage = type("MakefilePackage", (), {})
    stub.CMakePackage = type("CMakePackage", (), {"define": lambda self, *words: words})
    sys.modules["spack"] = types.ModuleType("spack")
    sys.modules["spack.package"] = stub
    source = (INSTALL / f"spack/packages/{name}/package.py").read_text(encoding="utf-8")
    names = {}
    exec(compile(source, name, "exec"), names)  # pylint: disable=exec-used
    return names[name.capitalize()], called


def needs(called):
    """Names of the packages that a recipe depends on."""
    return {re.match(r"[a-z0-9-]+", words[0])[0] for kind, words, _ in called if kind == "depends_on"}


def image_has_the_packages_of_the_makefile():
    """No more, no fewer."""
    install = re.search(r"apt-get install [-a-z ]*? ((?:[a-z0-9][a-z0-9.+-]*\s+)+)&&", instructions("RUN")[0])[1]
    assert sorted(install.split()) == sorted(makefile("BUILD_TOOLS") + makefile("PACKAGES_RUN")), install


def image_has_the_sources():
    """All that is built from and installed: every folder and file of the top that is the program's."""
    copied = {name for line in instructions("COPY") for name in line.split()[:-1]}
    assert all((TOP / name).exists() for name in copied), copied
    staged = re.search(r"put 644 share/doc/stance (.*)", (INSTALL / "stage.sh").read_text(encoding="utf-8"))[1]
    assert copied >= {"Makefile", "engine", "runner", "analysis", "scenarios"} | set(staged.split()), copied


def image_names_no_registry():
    """Whoever builds it has one configured."""
    assert instructions("FROM") == ["debian:12"], instructions("FROM")


def spack_has_the_libraries_of_the_makefile():
    """By the names that it has for them."""
    debian = set(makefile("PACKAGES_RUN")) - WITH_OTHERS
    assert debian == set(SPACK), debian ^ set(SPACK)
    missing = set(SPACK.values()) - needs(load("stance")[1])
    assert not missing, missing


def spack_has_the_libraries_of_the_page():
    """The table of the runner's page, but for what tests, pages and benchmarks need."""
    page = (TOP / "runner/README.md").read_text(encoding="utf-8")
    table = page.split("## What it is built on")[1].split("## ")[0]
    told = set(re.findall(r"`(lib[a-z0-9-]+-dev|zlib1g-dev|gnuplot-nox)`", table))
    told -= {"libc6-dev", "libclang-rt-dev", "libmujoco-dev", "libhdf5-dev"}
    have = needs(load("stance")[1])
    assert told >= {"libhdf5-openmpi-dev", "libslicot-dev", "libgsl-dev"}, told
    assert all(SPACK[name] in have for name in told), told


def spack_builds_by_the_makefile():
    """With variables that it knows, and a version that is the program's."""
    recipe, called = load("stance")
    assert recipe.__mro__[1].__name__ == "MakefilePackage"
    package = recipe()
    package.prefix = "/prefix"
    header = (TOP / "runner/base/command.h").read_text(encoding="utf-8")
    version = re.search(r'STANCE_VERSION "(.*?)"', header)[1]
    assert [words for kind, words, _ in called if kind == "version"] == [(version,)], version
    for mpi in True, False:
        package.spec = types.SimpleNamespace(satisfies=lambda words, mpi=mpi: words == "+mpi" and mpi)
        for targets in package.build_targets, package.install_targets:
            for setting in filter(lambda word: "=" in word, targets):
                assert makefile(setting.split("=")[0]), setting
            subprocess.run(["make", "-n", "-C", TOP, "BUILD=build/none", "PROGRAM=build/none/stance", *targets],
                           check=True, capture_output=True)
        assert package.install_targets[0] == "install" and f"MPI={int(mpi)}" in package.build_targets


def spack_builds_slicot():
    """With the LAPACK that the program has."""
    recipe, called = load("slicot")
    assert recipe.__mro__[1].__name__ == "CMakePackage" and recipe().cmake_args()
    assert "netlib-lapack" in needs(called)


tap([image_has_the_packages_of_the_makefile, image_has_the_sources, image_names_no_registry,
     spack_has_the_libraries_of_the_makefile, spack_has_the_libraries_of_the_page,
     spack_builds_by_the_makefile, spack_builds_slicot])
