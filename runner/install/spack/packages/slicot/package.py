"""SLICOT, which Spack's own packages lack."""
from spack.package import *

try:  # where Spack 1 keeps it
    from spack_repo.builtin.build_systems.cmake import CMakePackage
except ImportError:
    pass


class Slicot(CMakePackage):
    """Subroutines of systems and control theory."""

    git = "https://github.com/SLICOT/SLICOT-Reference.git"
    license("BSD-3-Clause")
    version("5.9.1", tag="v5.9.1")

    depends_on("c", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.15:", type="build")
    depends_on("netlib-lapack")

    def cmake_args(self):
        return [self.define("SLICOT_TESTING", False)]
