# Where the libraries are. MPI=0 builds for one rank with the serial HDF5.
PKG_CONFIG ?= pkg-config
SERIAL_PACKAGES = yaml-0.1 jansson gsl lapacke

LAPACK_CFLAGS := $(shell $(PKG_CONFIG) --cflags lapacke 2>/dev/null)
ifeq ($(MPI),1)
HDF5_PACKAGE  = hdf5-openmpi
PROGRAM_MPI  := -DSTANCE_MPI $(shell mpicc --showme:compile 2>/dev/null)
MPI_LIBS     := $(shell mpicc --showme:link 2>/dev/null)
else
HDF5_PACKAGE  = hdf5-serial
endif
PROGRAM_CFLAGS := $(PROGRAM_MPI) $(shell $(PKG_CONFIG) --cflags $(HDF5_PACKAGE) yaml-0.1 jansson 2>/dev/null)
LINK = $(CC) $(CFLAGS) $(SANITIZE)
LIBS := $(shell $(PKG_CONFIG) --libs $(HDF5_PACKAGE) yaml-0.1 jansson lapacke 2>/dev/null) \
        -lhdf5_hl $(MPI_LIBS) -lslicot -llapack -lblas -lm
