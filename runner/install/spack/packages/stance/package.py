"""Spack builds this source tree, see repo.yaml."""
from spack.package import *

try:  # where Spack 1 keeps it
    from spack_repo.builtin.build_systems.makefile import MakefilePackage
except ImportError:
    pass


class Stance(MakefilePackage):
    """Planar robots with exact contact, simulated in batches; their stability domains."""

    license("GPL-3.0-or-later")
    version("0.1.0")
    variant("mpi", default=True, description="several ranks; without it shards and merge")

    depends_on("c", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("openmpi", when="+mpi")  # the Makefile asks its mpicc for flags
    depends_on("hdf5@1.10: +hl")
    depends_on("hdf5 +mpi", when="+mpi")
    depends_on("hdf5 ~mpi", when="~mpi")
    depends_on("libyaml")
    depends_on("netlib-lapack +lapacke")
    depends_on("slicot")
    depends_on("sundials@6 +ARKODE ~mpi")
    depends_on("gsl")
    depends_on("random123", type="build")
    depends_on("jansson")
    depends_on("openssl")
    depends_on("zlib-api")
    depends_on("libxml2")
    depends_on("gnuplot", type="run")

    @property
    def build_targets(self):
        return ["HDF5_PACKAGE=hdf5", "MPI=1" if self.spec.satisfies("+mpi") else "MPI=0"]

    @property
    def install_targets(self):
        return ["install", f"PREFIX={self.prefix}"] + self.build_targets
