# stance: build, test, demonstrate. `make help` lists the targets.
.DEFAULT_GOAL := all
MAKEFLAGS += --no-print-directory
BUILD   ?= build
PROGRAM  = bin/stance
PREFIX  ?= /usr/local
CC       = gcc
MPI     ?= 1
CFLAGS  ?= -O2 -g
KERNEL_CFLAGS ?= -O3 -g
PYTHON  ?= /usr/bin/python3

WARNINGS = -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Werror
# The same bits on every machine: no contraction, no reassociation.
STRICT   = -std=c17 -D_GNU_SOURCE -ffp-contract=off -fno-math-errno -fno-trapping-math

# ---- libraries: found with pkg-config and mpicc; MPI=0 builds for one rank with serial HDF5 ------
PKG_CONFIG ?= pkg-config
PACKAGES_RUN  = libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libyaml-dev liblapacke-dev \
                libslicot-dev libsundials-dev librandom123-dev libjansson-dev gnuplot-nox fonts-dejavu-core
PACKAGES_TEST = libcmocka-dev python3-h5py python3-xarray python3-netcdf4 python3-scipy netcdf-bin
PACKAGES_LINT = clang-format clang-tidy cppcheck
BUILD_TOOLS   = gcc make pkg-config

ifeq ($(MPI),1)
HDF5_PACKAGE = hdf5-openmpi
MPI_CFLAGS   = -DSTANCE_MPI $(shell mpicc --showme:compile 2>/dev/null)
MPI_LIBS     = $(shell mpicc --showme:link 2>/dev/null)
else
HDF5_PACKAGE = hdf5-serial
endif
LIBRARY_CFLAGS := $(shell $(PKG_CONFIG) --cflags $(HDF5_PACKAGE) yaml-0.1 jansson lapacke 2>/dev/null)
LIBRARIES      := $(shell $(PKG_CONFIG) --libs $(HDF5_PACKAGE) yaml-0.1 jansson lapacke 2>/dev/null)
PROGRAM_CFLAGS  = $(MPI_CFLAGS) $(LIBRARY_CFLAGS)
LIBS            = $(LIBRARIES) -lhdf5_hl $(MPI_LIBS) -lslicot -llapack -lblas \
                  -lsundials_arkode -lsundials_nvecserial -lm

# `make V=1` shows whole commands.
ifneq ($(V),1)
QUIET = @echo '  $(1) $(2)';
endif

ALLFLAGS = $(STRICT) $(WARNINGS) $(SANITIZE)

# ---- the engine: a library without MPI, HDF5, YAML, files or terminals ---------------------------
SCENES  = ball block rod biped
METHODS = implicit midpoint capturing lagrange
SCALAR_METHODS = event_driven
MACHINE := $(shell uname -m)
ISAS_x86_64  = scalar sse2 avx2 avx512
ISAS_aarch64 = scalar neon
ISAS    := $(or $(ISAS_$(MACHINE)),scalar)
isa_flags_scalar = -DSTANCE_LANES=1 -mfma
isa_flags_sse2   = -DSTANCE_LANES=2
isa_flags_neon   = -DSTANCE_LANES=2
isa_flags_avx2   = -DSTANCE_LANES=4 -mavx2 -mfma
isa_flags_avx512 = -DSTANCE_LANES=8 -mavx512f -mavx512dq -mavx512vl

kernels := $(foreach s,$(SCENES),$(foreach m,$(METHODS),$(foreach i,$(ISAS),$(s)-$(m)-$(i)))) \
           $(foreach s,$(SCENES),$(foreach m,$(SCALAR_METHODS),$(s)-$(m)-scalar))
kernel_objects := $(kernels:%=$(BUILD)/kernel/%.o)
engine_sources := $(wildcard engine/*.c engine/control/*.c engine/scenes/*.c)
engine_objects := $(engine_sources:%.c=$(BUILD)/%.o) $(kernel_objects)
isa_list = -DSTANCE_ISA_LIST='$(foreach i,$(ISAS),X($(i)))'

# ---- the program ---------------------------------------------------------------------------------
program_sources := $(wildcard runner/*.c analysis/*.c)
program_objects := $(program_sources:%.c=$(BUILD)/%.o)
shared_objects   = $(filter-out $(BUILD)/runner/main.o,$(program_objects))

REVISION := $(shell git describe --always --dirty --abbrev=12 2>/dev/null || echo unknown)
BUILD_INFO = -DSTANCE_REVISION='"$(REVISION)"' \
             -DSTANCE_COMPILER='"$(shell $(CC) --version | head -n 1)"' \
             -DSTANCE_CFLAGS='"$(KERNEL_CFLAGS) $(STRICT)"'

.PHONY: all help packages demo test test-long bench lint sanitize install clean FORCE
all: $(PROGRAM)

$(PROGRAM): $(program_objects) $(BUILD)/libstance.a
	@mkdir -p $(@D)
	$(call QUIET,link,$@)$(CC) $(CFLAGS) $(SANITIZE) -o $@ $^ $(LDFLAGS) $(LIBS)

$(BUILD)/libstance.a: $(engine_objects)
	$(call QUIET,ar,$@)rm -f $@ && ar rcs $@ $^

define kernel_rule
$(BUILD)/kernel/$(1)-$(2)-$(3).o: engine/methods/$(2).c Makefile
	@mkdir -p $$(@D)
	$$(call QUIET,kernel,$$@)$$(CC) $$(KERNEL_CFLAGS) $$(ALLFLAGS) $$(isa_flags_$(3)) -DSTANCE_SCENE=$(1) -DSTANCE_ISA=$(3) $(if $(filter $(firstword $(SCENES))-scalar,$(1)-$(3)),-DSTANCE_DESCRIBE_METHOD) \
	    -DSTANCE_SCENE_LANES='"../scenes/$(1)_lanes.h"' -MMD -MP -c -o $$@ $$<
endef
$(foreach s,$(SCENES),$(foreach m,$(METHODS),$(foreach i,$(ISAS),\
$(eval $(call kernel_rule,$(s),$(m),$(i))))))
$(foreach s,$(SCENES),$(foreach m,$(SCALAR_METHODS),$(eval $(call kernel_rule,$(s),$(m),scalar))))

$(BUILD)/engine/%.o: engine/%.c Makefile
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(isa_list) $(LIBRARY_CFLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/runner/%.o: runner/%.c Makefile
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(PROGRAM_CFLAGS) $(EXTRA) -MMD -MP -c -o $@ $<
$(BUILD)/analysis/%.o: analysis/%.c Makefile
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -MP -c -o $@ $<
# What the build was is recorded in one object, made anew when the revision changes.
$(BUILD)/runner/build_info.o: EXTRA = $(BUILD_INFO)
$(BUILD)/runner/build_info.o: $(BUILD)/revision
# The table of kernels is made anew when the list of what it holds changes.
$(BUILD)/engine/kernels.o: $(BUILD)/isas
$(BUILD)/isas: FORCE
	@mkdir -p $(@D); echo '$(SCENES) $(METHODS) $(ISAS)' | cmp -s - $@ || echo '$(SCENES) $(METHODS) $(ISAS)' > $@
$(BUILD)/revision: FORCE
	@mkdir -p $(@D); echo '$(REVISION)' | cmp -s - $@ || echo '$(REVISION)' > $@

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

# ---- tests ---------------------------------------------------------------------------------------
test_sources  := $(wildcard tests/test_*.c)
test_programs := $(test_sources:tests/%.c=$(BUILD)/tests/%)

$(BUILD)/tests/%: tests/%.c $(shared_objects) $(BUILD)/libstance.a
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -MP -MF $@.d -o $@ $< $(shared_objects) \
	    $(BUILD)/libstance.a $(LDFLAGS) $(LIBS) -lcmocka

# What Open MPI wants in a container, as root, on few cores.
MPI_ENVIRONMENT = OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
                  OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_rmaps_base_oversubscribe=1
TEST_ENVIRONMENT = $(MPI_ENVIRONMENT) BUILD=$(BUILD) PYTHON=$(PYTHON) STANCE=$(abspath $(PROGRAM))

test: packages-test
	$(MAKE) check
check: $(PROGRAM) $(test_programs)
	@$(TEST_ENVIRONMENT) bash tests/run.sh
test-long: packages-test
	$(MAKE) $(PROGRAM) $(test_programs)
	@$(TEST_ENVIRONMENT) STANCE_TEST_LONG=1 bash tests/run.sh

# ---- what a new user types -----------------------------------------------------------------------
# Installs Debian packages that are missing (as root or with sudo), else names them.
packages packages-test: packages%:
	@need="$(BUILD_TOOLS) $(PACKAGES_RUN) $(if $(filter -test,$*),$(PACKAGES_TEST) $(PACKAGES_LINT))"; \
	missing=; for p in $$need; do \
	    dpkg-query -W -f '$${db:Status-Status}\n' $$p 2>/dev/null | grep -qx installed || missing="$$missing $$p"; done; \
	[ -z "$$missing" ] && exit 0; \
	if [ "$$(id -u)" = 0 ]; then as=; elif command -v sudo >/dev/null; then as=sudo; \
	else echo "missing packages; install them as root: apt-get install$$missing" >&2; exit 1; fi; \
	echo "installing$$missing"; \
	$$as apt-get update -qq && DEBIAN_FRONTEND=noninteractive $$as apt-get install -y -qq --no-install-recommends $$missing >/dev/null

CORES := $(shell nproc)
demo: packages
	$(MAKE) bin/stance
	@mkdir -p results
	$(MPI_ENVIRONMENT) mpirun -n $(CORES) bin/stance run --force scenarios/basin_one_foot.yaml
	bin/stance summary results/basin_one_foot.h5
	@echo; echo "The stability domain, drawn:"; bin/stance plot results/basin_one_foot.h5

bench: bin/stance
	bin/stance bench

lint: packages-test
	@bash tests/lint.sh

sanitize:
	STANCE_SLOW=1 $(MAKE) BUILD=build/sanitize PROGRAM=build/sanitize/bin/stance CFLAGS='-O1 -g' KERNEL_CFLAGS='-O1 -g' \
	    SANITIZE='-fsanitize=address,undefined -fno-sanitize-recover=undefined' check

install: bin/stance
	install -D -m 755 bin/stance $(DESTDIR)$(PREFIX)/bin/stance
	for f in scenarios/*.yaml scenarios/*/*.yaml; do install -D -m 644 $$f $(DESTDIR)$(PREFIX)/share/stance/$$f; done

clean:
	rm -rf build bin

help:
	@echo 'make            build bin/stance'
	@echo 'make demo       install what is missing, build, map a stability domain, draw it'
	@echo 'make test       install what is missing, build, run every test'
	@echo 'make test-long  the same with the long tests'
	@echo 'make bench      speed of the stepping kernels'
	@echo 'make lint       format, clang-tidy, cppcheck, symbol prefixes, include rules'
	@echo 'make sanitize   the tests under the address and undefined-behaviour sanitizers'
	@echo 'make install    PREFIX=/usr/local DESTDIR='
	@echo 'make MPI=0      a build for one rank, with serial HDF5 and without MPI'
