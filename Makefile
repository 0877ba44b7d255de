# stance: build, test, demonstrate. `make help` lists the targets.
.DEFAULT_GOAL := all
MAKEFLAGS += --no-print-directory
BUILD   ?= build
PROGRAM  = bin/stance
PREFIX  ?= /usr/local
CC       = gcc
MPI     ?= 1
CFLAGS  ?= -O2 -g
KERNEL_CFLAGS ?= -O3 -g1
PYTHON  ?= /usr/bin/python3

WARNINGS = -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Werror
# The same bits on every machine: no contraction, no reassociation. In spite of the former GCC's SLP
# vectoriser (12's, say) fuses a * b - c, d * e + f where there are instructions for the pair.
STRICT   = -std=c17 -D_GNU_SOURCE -ffp-contract=off -fno-tree-slp-vectorize -fno-math-errno -fno-trapping-math

# ---- libraries: found with pkg-config and mpicc; MPI=0 builds for one rank with serial HDF5 ------
PKG_CONFIG ?= pkg-config
PACKAGES_RUN  = libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libyaml-dev liblapacke-dev \
                libslicot-dev libsundials-dev libgsl-dev librandom123-dev libjansson-dev libssl-dev zlib1g-dev libxml2-dev \
                gnuplot-nox fonts-dejavu-core libmujoco-dev
PACKAGES_TEST = libcmocka-dev python3-yaml python3-jsonschema man-db python3-h5py python3-xarray python3-netcdf4 python3-scipy netcdf-bin \
                poppler-utils
PACKAGES_LINT = clang-format clang-tidy cppcheck
PACKAGES_FUZZ = clang libclang-rt-dev
PACKAGES_NEON = gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user-static
CLANG_VERSION = $(shell clang -dumpversion 2>/dev/null | cut -d. -f1)
PACKAGES_WEB  = clang lld llvm wasi-libc libclang-rt-$(CLANG_VERSION:%=%-)dev-wasm32 $(if $(shell command -v node),,nodejs) $(if $(shell command -v npm),,npm)
PACKAGES_SLURM = munge slurmctld slurmd slurm-client
PACKAGES_HOSTS = iproute2
PACKAGES_BENCH = libsiconos-kernel-dev libsiconos-numerics-dev valgrind linux-perf
BUILD_TOOLS   = gcc make pkg-config

ifeq ($(MPI),1)
HDF5_PACKAGE = hdf5-openmpi
MPI_CFLAGS   = -DSTANCE_MPI $(shell mpicc --showme:compile 2>/dev/null)
MPI_LIBS     = $(shell mpicc --showme:link 2>/dev/null)
else
HDF5_PACKAGE = hdf5-serial
endif
LIBRARY_CFLAGS := $(shell $(PKG_CONFIG) --cflags $(HDF5_PACKAGE) yaml-0.1 jansson lapacke gsl zlib 2>/dev/null)
LIBRARIES      := $(shell $(PKG_CONFIG) --libs $(HDF5_PACKAGE) yaml-0.1 jansson lapacke gsl zlib 2>/dev/null)
XML_CFLAGS     := $(shell $(PKG_CONFIG) --cflags libxml-2.0 2>/dev/null)
XML_LIBS       := $(or $(shell $(PKG_CONFIG) --libs libxml-2.0 2>/dev/null),-lxml2)
PROGRAM_CFLAGS  = $(MPI_CFLAGS) $(LIBRARY_CFLAGS)
LIBS            = $(LIBRARIES) -lhdf5_hl $(MPI_LIBS) -lslicot -llapack -lblas \
                  -lsundials_arkode -lsundials_nvecserial -lcrypto $(XML_LIBS) -lm

# `make V=1` shows whole commands.
ifneq ($(V),1)
QUIET = @echo '  $(1) $(2)';
endif

# gcc infers worse how long numbers are in instrumented code.
ALLFLAGS = -I. $(STRICT) $(WARNINGS) $(SANITIZE) $(if $(SANITIZE),-Wno-format-truncation)

# Each function in a section of its own, but for kernels: test programs leave out what they do not call.
SECTIONS = -ffunction-sections -fdata-sections
# ---- the engine: a library without MPI, HDF5, YAML, files or terminals ---------------------------
# Structures that kernels are compiled for ahead, and the one that reads any at run time. Others are compiled on demand.
STRUCTURES = biped
RUNTIME = runtime
METHODS = implicit midpoint capturing lagrange
SCALAR_METHODS = event_driven
MACHINE := $(shell uname -m)
# Slow to fast: sse2 has to emulate fused multiply-adds and is for processors without them.
ISAS_x86_64  = sse2 scalar avx2 avx512
ISAS_aarch64 = scalar neon
ISAS_wasm32  = wasm128
every_isa   := $(or $(ISAS_$(MACHINE)),scalar)
# Built: one lane, and the most that this processor has. `make ISAS=all` is for other processors, too.
processor   := $(if $(filter x86_64,$(MACHINE)),$(shell grep -m1 -o 'avx512dq' /proc/cpuinfo || grep -m1 -ow 'avx2' /proc/cpuinfo || echo sse2))
own_isa     := $(if $(processor),$(processor:avx512dq=avx512),$(lastword $(every_isa)))
ISAS        ?= scalar $(own_isa)
override ISAS := $(or $(filter $(ISAS:all=%),$(every_isa)),$(every_isa))
fma_x86_64       = -mfma
isa_flags_scalar = -DSTANCE_LANES=1 $(fma_$(MACHINE))
isa_flags_sse2   = -DSTANCE_LANES=2
isa_flags_neon   = -DSTANCE_LANES=2
isa_flags_wasm128 = -DSTANCE_LANES=2 -msimd128
isa_flags_avx2   = -DSTANCE_LANES=4 -mavx2 -mfma
isa_flags_avx512 = -DSTANCE_LANES=8 -mavx512f -mavx512dq -mavx512vl -mfma
# Methods that take one case at a time run on every processor.
scalar_method_flags = -DSTANCE_LANES=1
# Loops over contacts are unrolled before gcc knows which of them a set leaves out.
kernel_warnings = -Wno-maybe-uninitialized -Wno-array-bounds

# Ahead for the fastest, which the others are held to be equal to; `make ISAS=all` for all.
ahead_isas     := $(if $(filter $(words $(every_isa)),$(words $(ISAS))),$(ISAS),$(or $(filter $(own_isa),$(ISAS)),$(lastword $(ISAS))))
# Where the structure is read at run time, eight lanes are 2.7 times as fast as one (walker2d, let go).
runtime_isas   := $(or $(filter avx2 avx512 neon wasm128,$(ahead_isas)),$(lastword $(ahead_isas)))
kernels        := $(foreach s,$(STRUCTURES),$(foreach m,$(METHODS),$(foreach i,$(ahead_isas),$(s)-$(m)-$(i)))) \
                  $(foreach m,$(METHODS),$(foreach i,$(runtime_isas),$(RUNTIME)-$(m)-$(i)))
scalar_kernels := $(foreach s,$(STRUCTURES) $(RUNTIME),$(foreach m,$(SCALAR_METHODS),$(s)-$(m)-scalar))
kernel_objects := $(patsubst %,$(BUILD)/kernel/%.o,$(kernels) $(scalar_kernels))
engine_sources := $(wildcard engine/*.c engine/core/lanes/*.c engine/laws/*.c engine/scenes/*.c)
engine_objects := $(engine_sources:%.c=$(BUILD)/%.o) $(kernel_objects)
control_objects := $(patsubst %.c,$(BUILD)/%.o,$(wildcard engine/control/*.c))
archives = $(BUILD)/libstance_control.a $(BUILD)/libstance.a
comma := ,
isa_list     = -DSTANCE_ISA_LIST='$(foreach i,$(ISAS),ISA($(i)))'
kernel_lists = $(isa_list) -DSTANCE_METHOD_LIST='$(foreach m,$(METHODS) $(SCALAR_METHODS),METHOD($(m)))' \
    -DSTANCE_KERNEL_LIST='$(foreach k,$(kernels),KERNEL($(subst -,$(comma),$(k))))' \
    -DSTANCE_SCALAR_KERNEL_LIST='$(foreach k,$(scalar_kernels),KERNEL($(subst -,$(comma),$(k))))'

# Objects are made anew when the flags change, not with the rest of this file.
flags := $(CC) $(KERNEL_CFLAGS) $(CFLAGS) $(ALLFLAGS) $(SECTIONS) $(kernel_warnings) $(PROGRAM_CFLAGS) $(foreach i,$(every_isa),$(isa_flags_$i))
$(BUILD)/flags: FORCE
	@mkdir -p $(@D); echo '$(flags)' | cmp -s - $@ || echo '$(flags)' > $@

# Where pages are made, see below.
WEB = build/web

# ---- the program ---------------------------------------------------------------------------------
program_sources := $(wildcard runner/*.c runner/*/*.c analysis/*/*.c)
program_objects := $(program_sources:%.c=$(BUILD)/%.o)
# What test programs link: what they use of the program, and nothing that changes with the revision, so that
# they are the same files, and need not run again, as long as nothing that they use has changed.
product          = $(BUILD)/tests/build_info.o $(BUILD)/libproduct.a $(archives)
TEST_CFLAGS      = $(if $(SANITIZE),$(CFLAGS),-O1)
test_ldflags     = -Wl,--gc-sections $(if $(SANITIZE),,-Wl,--strip-debug)

REVISION := $(shell git describe --always --dirty --abbrev=12 2>/dev/null || echo unknown)
BUILD_INFO = -DSTANCE_REVISION='"$(REVISION)"' \
             -DSTANCE_COMPILER='"$(shell $(CC) --version | head -n 1)"' \
             -DSTANCE_CFLAGS='"$(KERNEL_CFLAGS) $(STRICT)"'

.PHONY: all help packages demo golden golden-memory golden-neon golden-web web web-page test check check-programs check-scripts check-length test-scripts test-length mutations test-neon test-web test-long test-kills hunt test-slurm test-hosts fuzz fuzz-programs bench bench-run truths bench-peers bench-peers-run bench-web bench-schedule profile lint sanitize install uninstall clean FORCE
all: $(PROGRAM)

$(PROGRAM): $(program_objects) $(archives)
	@mkdir -p $(@D)
	$(call QUIET,link,$@)$(CC) $(CFLAGS) $(SANITIZE) -o $@ $^ $(LDFLAGS) $(LIBS)

$(BUILD)/libstance.a: $(engine_objects)
$(BUILD)/libstance_control.a: $(control_objects)
$(BUILD)/libproduct.a: $(filter-out %/main.o %/build_info.o,$(program_objects))
$(BUILD)/%.a:
	$(call QUIET,ar,$@)rm -f $@ && $(AR) rcs $@ $^

define kernel_rule
$(BUILD)/kernel/$(1)-$(2)-$(3).o: engine/methods/$(2).c $(BUILD)/flags
	@mkdir -p $$(@D)
	$$(call QUIET,kernel,$$@)$$(CC) $$(KERNEL_CFLAGS) $$(ALLFLAGS) $$(kernel_warnings) $(4) -DSTANCE_SCENE=$(1) -DSTANCE_ISA=$(3) \
	    -DSTANCE_SCENE_LANES='"engine/scenes/$(1)_lanes.h"' -MMD -MP -c -o $$@ $$<
endef
$(foreach s,$(STRUCTURES),$(foreach m,$(METHODS),$(foreach i,$(ISAS),\
$(eval $(call kernel_rule,$(s),$(m),$(i),$(isa_flags_$(i)))))))
$(foreach m,$(METHODS),$(foreach i,$(runtime_isas),$(eval $(call kernel_rule,$(RUNTIME),$(m),$(i),$(isa_flags_$(i))))))
$(foreach s,$(STRUCTURES) $(RUNTIME),$(foreach m,$(SCALAR_METHODS),$(eval $(call kernel_rule,$(s),$(m),scalar,$(scalar_method_flags)))))

$(BUILD)/engine/%.o: engine/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(SECTIONS) $(ALLFLAGS) $(EXTRA) $(LIBRARY_CFLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/runner/%.o: runner/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(SECTIONS) $(ALLFLAGS) $(PROGRAM_CFLAGS) $(EXTRA) -MMD -MP -c -o $@ $<
$(BUILD)/analysis/%.o: analysis/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(SECTIONS) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -MP -c -o $@ $<
# The scripts of pictures, embedded in gnuplot.o.
$(foreach b,$(BUILD) $(BUILD)/fuzz,$(eval $(b)/analysis/draw/gnuplot.o: $(wildcard analysis/draw/*.gp)))
# The page that `stance view` fills, and the engines that it may carry, where `make web` has made them.
PAGE = $(wildcard $(WEB)/page.html)
$(BUILD)/analysis/view/page_template.o: PROGRAM_CFLAGS += $(PAGE:%=-DSTANCE_PAGE='"%"' -DSTANCE_PAGE_ENGINES='$(foreach s,$(STRUCTURES) $(RUNTIME),ENGINE($(s)))')
$(BUILD)/analysis/view/page_template.o: $(PAGE)
# Files of other programs; libmujoco is loaded when it is asked for, by what its header says.
$(BUILD)/runner/import/%.o $(BUILD)/fuzz/runner/import/%.o: EXTRA = $(XML_CFLAGS)
$(patsubst %.c,$(BUILD)/%.o,$(wildcard runner/import/*.c)): $(BUILD)/simulators
# What the build was is recorded in one object, made anew when the revision changes.
$(BUILD)/runner/store/build_info.o: EXTRA = $(BUILD_INFO)
$(BUILD)/runner/store/build_info.o: $(BUILD)/revision
# Kernels that are compiled on demand: the sources that the program carries, and how it compiles them.
carried = $(sort $(wildcard engine/*.h engine/core/*/*.h engine/scenes/tree_*.h) $(wildcard runner/objects/law/*)) $(METHODS:%=engine/methods/%.c)
$(BUILD)/runner/objects/sources.o: EXTRA = -DSTANCE_SOURCES='$(foreach f,$(carried),SOURCE("$(f)"))'
$(BUILD)/runner/objects/sources.o: $(carried)
$(BUILD)/runner/objects/compiler.o: EXTRA = \
    -DSTANCE_OBJECT_FLAGS='"$(filter-out -g%,$(KERNEL_CFLAGS)) $(STRICT)"' \
    -DSTANCE_OBJECT_ISAS='$(foreach i,$(ISAS),ISA($(i),$(isa_flags_$(i))))'
$(BUILD)/runner/objects/sources.o $(BUILD)/runner/objects/compiler.o: $(BUILD)/kernels
# The table of kernels is made anew when the list of what it holds changes.
$(BUILD)/engine/kernels.o: EXTRA = $(kernel_lists)
$(BUILD)/engine/kernels.o: $(BUILD)/kernels
$(BUILD)/kernels: FORCE
	@mkdir -p $(@D); echo '$(kernels) $(scalar_kernels)' | cmp -s - $@ || echo '$(kernels) $(scalar_kernels)' > $@
$(BUILD)/revision: FORCE
	@mkdir -p $(@D); echo '$(REVISION)' | cmp -s - $@ || echo '$(REVISION)' > $@

%.d: ; # made with the objects
-include $(shell find $(BUILD) -name '*.d' -type f 2>/dev/null)

# ---- tests ---------------------------------------------------------------------------------------
# Other simulators, where they are installed when make begins: nothing else asks. Without them what compares
# with them is skipped.
MUJOCO  := $(if $(wildcard /usr/include/mujoco/mujoco.h),-lmujoco)
SICONOS := $(patsubst %/SiconosConfig.h,%,$(wildcard /usr/include/siconos/SiconosConfig.h))
test_sources  := $(wildcard tests/test_*.c)
test_programs := $(test_sources:tests/%.c=$(BUILD)/tests/%)

# Other simulators on the charts of error against cost, for bench_peers.
peer_programs = $(BUILD)/tests/peer_self $(if $(MUJOCO),$(BUILD)/tests/peer_mujoco) $(if $(SICONOS),$(BUILD)/tests/peer_siconos)

# What whole-program tests call.
other_programs = $(BUILD)/tests/bench_schedule $(BUILD)/tests/bench_truths $(BUILD)/tests/golden $(BUILD)/tests/mechanism_numbers

$(BUILD)/tests/%.o: tests/%.c $(BUILD)/flags $(BUILD)/kernels
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(TEST_CFLAGS) $(ALLFLAGS) $(kernel_warnings) $(PROGRAM_CFLAGS) $(isa_list) $(EXTRA) -MMD -MP -c -o $@ $<
$(test_programs) $(BUILD)/tests/peer_self: $(BUILD)/tests/%: $(BUILD)/tests/%.o $(product)
	$(call QUIET,link,$@)$(CC) $(TEST_CFLAGS) $(SANITIZE) -o $@ $< $(test_objects) $(product) $(test_ldflags) $(LDFLAGS) $(LIBS) -lcmocka
.PRECIOUS: $(BUILD)/tests/%.o
$(BUILD)/tests/build_info.o: runner/store/build_info.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -MP -c -o $@ $<

# Each instruction set's fused multiply-adds, for test_fma.
fused_objects = $(ISAS:%=$(BUILD)/tests/lanes_fma-%.o)
$(BUILD)/tests/lanes_fma-%.o: tests/lanes_fma.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(isa_list) $(isa_flags_$*) -DSTANCE_ISA=$* -MMD -MP -c -o $@ $<
$(BUILD)/tests/test_fma: $(fused_objects) $(BUILD)/kernels
# What fuzzing calls, here with what it found.
$(BUILD)/tests/fuzz_scenario.o: tests/fuzz_scenario.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/tests/test_fuzz: $(BUILD)/tests/fuzz_scenario.o
$(BUILD)/tests/test_fuzz: test_objects = $(BUILD)/tests/fuzz_scenario.o
$(BUILD)/tests/test_fma: test_objects = $(fused_objects)

# Kernels of one lane that think their neighbours need everything: see core/lanes/lanes.h.
doubting         = $(foreach s,$(STRUCTURES),$(foreach m,$(METHODS),$(s)-$(m)))
doubting_objects = $(doubting:%=$(BUILD)/tests/doubting-%.o)
define doubting_rule
$(BUILD)/tests/doubting-$(1)-$(2).o: engine/methods/$(2).c $(BUILD)/flags
	@mkdir -p $$(@D)
	$$(call QUIET,cc,$$@)$$(CC) -O1 $$(ALLFLAGS) $$(kernel_warnings) $(isa_flags_scalar) -DSTANCE_DOUBT -DSTANCE_SCENE=$(1) -DSTANCE_ISA=doubting \
	    -DSTANCE_SCENE_LANES='"engine/scenes/$(1)_lanes.h"' -MMD -MP -c -o $$@ $$<
endef
$(foreach s,$(STRUCTURES),$(foreach m,$(METHODS),$(eval $(call doubting_rule,$(s),$(m)))))
$(BUILD)/tests/test_lanes: $(doubting_objects)
$(BUILD)/tests/test_lanes: test_objects = $(doubting_objects)
$(BUILD)/tests/test_lanes: EXTRA = -DSTANCE_DOUBTING_LIST='$(foreach k,$(doubting),KERNEL($(subst -,$(comma),$(k))))'

# What the engine says of mechanisms, for the independent program tests/mechanism_oracle.py.
$(BUILD)/tests/mechanism_numbers: tests/mechanism_numbers.c $(BUILD)/libstance.a
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) -MMD -MP -MF $@.d -o $@ $(filter %.c %.a,$^) $(LDFLAGS) $(LIBS)

# Hashes of what the kernels compute, and their speed, by programs of the engine alone that other
# machines run too.
$(BUILD)/tests/golden $(BUILD)/tests/bench_web: $(BUILD)/tests/%: tests/%.c $(BUILD)/libstance.a
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) -MMD -MP -MF $@.d -o $@ $(filter %.c %.a,$^) $(LDFLAGS) $(GOLDEN_LIBS)
golden: $(BUILD)/tests/golden
GOLDEN_LIBS = $(LIBS)

# The same for a 64-bit ARM, by Debian's cross compiler: the engine without what needs libraries.
NEON_CFLAGS ?= -O1
golden-neon:
	@$(MAKE) BUILD=build/neon$(NEON_CFLAGS) KERNEL_CFLAGS=$(NEON_CFLAGS) MACHINE=aarch64 \
	    CC=aarch64-linux-gnu-gcc SCALAR_METHODS= LIBRARY_CFLAGS= LDFLAGS=-static \
	    GOLDEN_LIBS=-lm golden

# The same for WebAssembly, run by node. Of Random123's processors, admitted by name, __riscv is one
# without instructions of its own. Kernels by -O2: smaller ones (-Oz) are half as large and 1.4 times
# as slow, -O3 is no quicker. The default stack would be overrun by a stream's bundles, unnoticed.
WEB_CC      = clang --target=wasm32-wasi -D__riscv -DR123_USE_GNU_UINT128=1
WEB_CFLAGS ?= -O2
WEB_LDFLAGS = -Wl,--gc-sections,--strip-all,-z,stack-size=8388608,--stack-first
WEB_MAKE    = $(MAKE) BUILD=$(WEB) MACHINE=wasm32 AR=llvm-ar CC='$(WEB_CC)' \
    CFLAGS=-Oz KERNEL_CFLAGS='$(WEB_CFLAGS)' LDFLAGS='$(WEB_LDFLAGS)' \
    WARNINGS='$(WARNINGS) -Wno-bitwise-instead-of-logical -Wno-pass-failed' kernel_warnings= \
    SCALAR_METHODS= LIBRARY_CFLAGS= GOLDEN_LIBS=-lm
golden-web:
	+@$(WEB_MAKE) golden

# ---- pages: the engine as WebAssembly, the page around it, see analysis/view/page -----------------
# The engine of a page reads scenarios, too, but no YAML and no files, and designs nothing.
page_sources := $(wildcard analysis/view/wasm/*.c) $(addprefix runner/base/,checksum.c numbers.c problem.c words.c) \
    $(addprefix runner/plan/,ground_line.c plan.c refine.c resolve.c shard.c) \
    $(filter-out %/command_describe.c %/describe.c %/scenario_file.c %/tree_yaml.c,$(wildcard runner/scenario/*.c))
# A page carries the engine of its file's scene.
engines = $(patsubst %,$(WEB)/engine-%.z,$(STRUCTURES) $(RUNTIME))
ifeq ($(BUILD),$(WEB))
page_objects = $(page_sources:%.c=$(WEB)/%.o)
define engine_rule
$(WEB)/kernels-$(1).o: engine/kernels.c $$(BUILD)/flags
	$$(call QUIET,cc,$$@)$$(CC) $$(CFLAGS) $$(ALLFLAGS) $$(isa_list) -DSTANCE_METHOD_LIST='$$(foreach m,$$(METHODS) event_driven,METHOD($$(m)))' \
	    -DSTANCE_KERNEL_LIST='$$(foreach m,$$(METHODS),KERNEL($(1),$$(m),$(2)))' -DSTANCE_SCALAR_KERNEL_LIST= -c -o $$@ $$<
$(WEB)/engine-$(1).wasm: $(WEB)/kernels-$(1).o $$(page_objects) $(WEB)/libstance.a
	$$(call QUIET,link,$$@)$$(CC) -mexec-model=reactor $$(LDFLAGS) -o $$@ $$^ -lm
endef
$(foreach s,$(STRUCTURES),$(eval $(call engine_rule,$(s),$(firstword $(ISAS)))))
$(eval $(call engine_rule,$(RUNTIME),$(firstword $(runtime_isas))))
%.z: %.wasm
	@node -e 'const fs = require("fs"), z = require("zlib"); fs.writeFileSync("$@", z.deflateSync(fs.readFileSync("$<"), {level: 9}))'
.PRECIOUS: $(WEB)/engine-%.wasm
$(WEB)/node_modules/made: analysis/view/page/package-lock.json
	$(call QUIET,npm,$(WEB)/node_modules)cp analysis/view/page/package*.json $(WEB) && cd $(WEB) && npm ci --no-audit --no-fund --loglevel=error >&2 && touch node_modules/made
$(WEB)/page.html: $(engines) $(WEB)/node_modules/made $(wildcard analysis/view/page/*)
	$(call QUIET,page,$@)node analysis/view/page/build.mjs $(WEB)/node_modules $@
endif
web-page:
	+@$(WEB_MAKE) MPI=0 $(WEB)/page.html
# Pages that simulate, the program that makes them, and pages of studies that ship.
GALLERY  = basin_one_foot basin_both_feet friction_sweep topple block_threshold painleve controllers/bimodal \
           controllers/switching mechanisms/compass_gait mechanisms/rabbit mechanisms/pushed balance_recovers walk_attempt gaits/walks
GALLERY_DIRECTORY = results/gallery
web: packages packages-web
	$(MAKE) -j$(CORES) web-page
	$(MAKE) -j$(CORES) $(PROGRAM)
	@mkdir -p $(GALLERY_DIRECTORY)
	@for s in $(GALLERY); do \
	    $(MPI_ENVIRONMENT) mpirun -n $(CORES) $(PROGRAM) run --quiet --force scenarios/$$s.yaml -o $(GALLERY_DIRECTORY)/$$(basename $$s).h5 || exit 1; done
	@echo "Studies to click through:"; $(PROGRAM) view $(patsubst %,$(GALLERY_DIRECTORY)/%.h5,$(notdir $(GALLERY))) -o $(GALLERY_DIRECTORY)

# Models of ours in MuJoCo; made anew when it comes or goes.
$(BUILD)/tests/test_export: LIBS += $(MUJOCO)
$(BUILD)/tests/test_export: EXTRA = $(MUJOCO:%=-DSTANCE_MUJOCO)
$(BUILD)/tests/test_export: $(BUILD)/simulators
$(BUILD)/tests/test_import.o: $(BUILD)/simulators
$(BUILD)/simulators: FORCE
	@mkdir -p $(@D); echo '$(MUJOCO)' | cmp -s - $@ || echo '$(MUJOCO)' > $@

# ---- benchmarks: what the kernels are held to -----------------------------------------------------
bench_programs = $(BUILD)/tests/bench_scalar $(if $(MUJOCO),$(BUILD)/tests/bench_mujoco)
$(BUILD)/tests/bench_mujoco: LIBS += $(MUJOCO)
# Of other simulators; they need nothing of ours but headers.
$(BUILD)/tests/peer_mujoco: tests/peer_mujoco.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(KERNEL_CFLAGS) $(ALLFLAGS) -MMD -MP -MF $@.d -o $@ $< $(LDFLAGS) $(MUJOCO) -lm
$(BUILD)/tests/peer_siconos: tests/peer_siconos.cpp tests/peer.h
	@mkdir -p $(@D)
	$(call QUIET,c++,$@)$(CXX) -std=c++17 -O2 -I. $(patsubst %,-isystem $(SICONOS)%,/ /kernel /numerics) -o $@ $< $(LDFLAGS) \
	    -lsiconos_kernel -lsiconos_numerics
# By hand as fast as the compiler makes it: the instructions of the one-lane kernel, contracted.
$(BUILD)/tests/bench_scalar: BENCH_FLAGS = $(filter -m%,$(isa_flags_scalar)) -ffp-contract=fast
$(BUILD)/tests/bench_%: tests/bench_%.c $(product)
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(KERNEL_CFLAGS) $(ALLFLAGS) $(BENCH_FLAGS) $(PROGRAM_CFLAGS) -MMD -MP -MF $@.d -o $@ $< \
	    $(test_objects) $(product) $(test_ldflags) $(LDFLAGS) $(LIBS)

# Large jobs on a simulated clock.
$(BUILD)/tests/simulate.o: tests/simulate.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,cc,$@)$(CC) $(CFLAGS) $(ALLFLAGS) -MMD -MP -c -o $@ $<
$(BUILD)/tests/bench_schedule $(BUILD)/tests/test_schedule: $(BUILD)/tests/simulate.o
$(BUILD)/tests/bench_schedule $(BUILD)/tests/test_schedule: test_objects = $(BUILD)/tests/simulate.o

# What Open MPI wants in a container, as root, on few cores. PMIx keeps its data in the memory of each
# process (hash): in shared memory (ds21) a mutex that a killed rank holds is never given back, and
# mpirun waits for it for ever when it ends (as it does now and then for a mutex of its own).
MPI_ENVIRONMENT = OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 PMIX_MCA_gds=hash \
                  OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_rmaps_base_oversubscribe=1
TEST_ENVIRONMENT = $(MPI_ENVIRONMENT) BUILD=$(BUILD) PYTHON=$(PYTHON) STANCE=$(abspath $(PROGRAM)) \
                   FUZZ_SECONDS=$(FUZZ_SECONDS) FUZZ_RUNS=$(FUZZ_RUNS)

# ARM's kernels against this machine's, in an emulator. `check-scripts` does so where the packages are, with
# kernels that are quicker to compile.
test-neon: packages-neon
	$(MAKE) ISAS=all golden
	@$(TEST_ENVIRONMENT) NEON_CFLAGS=-O3 bash tests/run.sh whole_machines
# The same cases in WebAssembly, many of them.
test-web: packages-pages
	$(MAKE) ISAS=all golden
	@$(TEST_ENVIRONMENT) GOLDEN_CASES=$(or $(GOLDEN_CASES),500) bash tests/run.sh whole_machines

# A share of every test; every script (also those with a line "# long") for every instruction set; the same at
# length. Pages are tested where they can be made: not without npm's registry. test-long: this and more, whose verdicts
# are kept (tests/long.sh).
test: packages-test
	$(MAKE) check
check-programs: $(PROGRAM) $(test_programs) $(other_programs)
check: check-programs
	@$(TEST_ENVIRONMENT) bash tests/run.sh
test-scripts test-length: test-%: packages-test
	+@$(MAKE) packages-pages && $(MAKE) web-page || echo 'test-$*: pages cannot be made here: their tests are skipped' >&2
	$(MAKE) ISAS=all check-$*
test-long:
	@bash tests/long.sh $(STAGES)
# How many deliberate faults the tests find: tests/mutations.py. An hour or two. ROWS: some of them.
MUTATIONS ?= /tmp/stance-mutations
mutations: packages-test
	@$(MPI_ENVIRONMENT) $(PYTHON) tests/mutations.py $(MUTATIONS) $(ROWS)
check-scripts check-length: check-%: check-programs $(BUILD)/tests/bench_peers $(peer_programs) fuzz-programs
	@$(TEST_ENVIRONMENT) STANCE_TEST_$(if $(filter length,$*),LONG,SCRIPTS)=1 bash tests/run.sh

# Numbers that depend on the neighbours: HUNT_CASES of each kind for every method of the biped, a core
# each, for an hour or so; a share is in `test`.
HUNT_CASES ?= 1e7
hunt: packages-test
	$(MAKE) $(BUILD)/tests/test_lanes
	@for m in $(METHODS); do for kind in ordinary extreme; do echo "$$m $$kind"; done; done | \
	    xargs -P $(CORES) -L 1 sh -c '$(BUILD)/tests/test_lanes biped $$0 $$1 $(HUNT_CASES) $(SEED)'

# Runs that are killed and resumed, files that are damaged: tests/campaign_*.py. Ten minutes or so.
KILLS ?= 200
FLIPS ?= 200
TRUNCATIONS ?= 50
SEED ?= 1
test-kills: packages-test
	$(MAKE) $(PROGRAM)
	@$(TEST_ENVIRONMENT) $(PYTHON) tests/campaign_kills.py --seed $(SEED) --kills $(KILLS)
	@$(TEST_ENVIRONMENT) $(PYTHON) tests/campaign_damage.py --seed $(SEED) --flips $(FLIPS) --truncations $(TRUNCATIONS)

# Batch scripts under a Slurm of the test's own; a run on several hosts, one cut off. As root.
test-slurm test-hosts: test-%: packages-%
	$(MAKE) $(PROGRAM)
	@$(TEST_ENVIRONMENT) bash tests/$*.sh

# ---- fuzzing: clang's libFuzzer and sanitizers, see tests/whole_fuzz.sh ---------------------------
# Everything but the kernels, which come from the library as it is: nothing is simulated.
FUZZ_CC      ?= clang
FUZZ_SECONDS ?= 30
FUZZ          = $(BUILD)/fuzz
FUZZ_CFLAGS   = -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined \
                -fsanitize-coverage=inline-8bit-counters,pc-table $(FUZZ_COVERAGE) -Wno-bitwise-instead-of-logical \
                -Wno-missing-field-initializers \
                '-DCMPLX(a,b)=__builtin_complex((double)(a),(double)(b))'
fuzz_sources := $(filter-out runner/main.c,$(program_sources)) $(filter-out engine/kernels.c,$(engine_sources))
fuzz_objects := $(fuzz_sources:%.c=$(FUZZ)/%.o)
# The sanitizers as a library, so that a crash tells their functions from ours; none: no fuzzing.
fuzz_library := $(filter /%,$(shell $(FUZZ_CC) -print-file-name=libclang_rt.asan-$(MACHINE).so 2>/dev/null))
# Where a command is to stay in the process: see tests/fuzz_results.c.
fuzz_wrapped  = sandbox sandbox_limit gnuplot_end parallel_start parallel_finish crash_watch
fuzz_programs = $(if $(fuzz_library),$(FUZZ)/fuzz_scenario $(FUZZ)/fuzz_results)

$(FUZZ)/%.o: %.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call QUIET,fuzz,$@)$(FUZZ_CC) -I. $(STRICT) $(WARNINGS) $(FUZZ_CFLAGS) $(PROGRAM_CFLAGS) $(EXTRA) -MMD -MP -c -o $@ $<
$(FUZZ)/runner/store/build_info.o: EXTRA = $(BUILD_INFO)
$(FUZZ)/runner/store/build_info.o: $(BUILD)/revision
$(FUZZ)/fuzz_scenario: $(FUZZ)/tests/fuzz_scenario.o $(FUZZ)/tests/fuzz_mutate.o $(fuzz_objects) $(archives)
	$(call QUIET,link,$@)$(FUZZ_CC) -fsanitize=address,undefined,fuzzer $(FUZZ_COVERAGE) -o $@ $^ $(LDFLAGS) $(LIBS)
$(FUZZ)/fuzz_results: $(FUZZ)/tests/fuzz_results.o $(FUZZ)/tests/fuzz_numbers.o $(FUZZ)/tests/damage.o $(fuzz_objects) $(archives)
	$(call QUIET,link,$@)$(FUZZ_CC) -fsanitize=address,undefined -shared-libasan -Wl,-rpath,$(dir $(fuzz_library)) \
	    $(foreach f,$(fuzz_wrapped),-Wl,--wrap=$(f)) $(FUZZ_COVERAGE) -o $@ $^ $(LDFLAGS) $(LIBS)

# A longer campaign: FUZZ_SECONDS=3600, or FUZZ_RUNS=1000000; `test-scripts` runs a share, too.
fuzz: packages-test
	$(MAKE) $(PROGRAM) fuzz-programs
	@$(TEST_ENVIRONMENT) bash tests/run.sh whole_fuzz
fuzz-programs: $(fuzz_programs)

# ---- what a new user types -----------------------------------------------------------------------
# Installs Debian packages that are missing (as root or with sudo), else names them.
packages packages-test packages-pages packages-neon packages-web packages-slurm packages-hosts packages-bench: packages%:
	@need="$(BUILD_TOOLS) $(PACKAGES_RUN) $(if $(filter -test,$*),$(PACKAGES_TEST) $(PACKAGES_LINT) $(PACKAGES_FUZZ)) \
	    $(if $(filter -slurm,$*),$(PACKAGES_SLURM) python3-h5py) $(if $(filter -hosts,$*),$(PACKAGES_HOSTS) python3-h5py) \
	    $(if $(filter -neon,$*),$(PACKAGES_NEON)) $(if $(filter -web -pages,$*),$(PACKAGES_WEB)) $(if $(filter -pages,$*),chromium) $(if $(filter -bench,$*),$(PACKAGES_BENCH))"; \
	missing=; for p in $$need; do \
	    dpkg-query -W -f '$${db:Status-Status}\n' $$p 2>/dev/null | grep -qx installed || missing="$$missing $$p"; done; \
	[ -z "$$missing" ] && exit 0; \
	if [ "$$(id -u)" = 0 ]; then as=; elif command -v sudo >/dev/null; then as=sudo; \
	else echo "missing packages; install them as root: apt-get install$$missing" >&2; exit 1; fi; \
	echo "installing$$missing"; \
	$$as apt-get update -qq && DEBIAN_FRONTEND=noninteractive $$as apt-get install -y -qq --no-install-recommends $$missing >/dev/null

CORES := $(shell nproc)
demo: packages
	+@$(MAKE) packages-web && $(MAKE) -j$(CORES) web-page || echo 'demo: goes on without a page that simulates' >&2
	$(MAKE) -j$(CORES) bin/stance
	@mkdir -p results
	$(MPI_ENVIRONMENT) mpirun -n $(CORES) bin/stance run --force scenarios/basin_one_foot.yaml
	bin/stance summary results/basin_one_foot.h5
	@echo; echo "The stability domain, drawn:"; bin/stance plot results/basin_one_foot.h5
	@[ ! -e $(WEB)/page.html ] || { echo; echo "As a page for the browser: click a case, and it is simulated and played:"; \
	    bin/stance view results/basin_one_foot.h5; }

# All speed benchmarks -> results/bench.csv and .png. Packages for comparisons are no necessity.
bench: packages
	@$(MAKE) packages-bench || echo 'bench: what needs $(PACKAGES_BENCH) and is missing is skipped' >&2
	@$(MAKE) bench-run
bench-run: $(PROGRAM) $(bench_programs)
	@$(TEST_ENVIRONMENT) bash tests/bench.sh
# Published numbers and closed forms, and what every method makes of them: table and picture.
truths: packages
	@$(MAKE) $(BUILD)/tests/bench_truths
	@mkdir -p results
	$(BUILD)/tests/bench_truths -o results/truth
# Error against cost beside other simulators, those that are installed or can be: about twenty minutes.
bench-peers: packages
	@$(MAKE) packages-bench || echo 'bench-peers: what needs $(PACKAGES_BENCH) and is missing is left out' >&2
	@$(MAKE) bench-peers-run
bench-peers-run: $(BUILD)/tests/bench_peers $(peer_programs)
	$(BUILD)/tests/bench_peers -o results/peers $(addprefix scenarios/accuracy/,drop.yaml basin_one_foot.yaml basin_both_feet.yaml) \
	    $(addprefix --peer ,$(filter-out %/peer_self,$(peer_programs))) --peer-starts 300 --peer-effort 6
# WebAssembly under node beside this machine's kernels and MuJoCo's own WebAssembly, if npm gives it.
MUJOCO_WEB = @mujoco/mujoco@3.14.0
bench-web: packages-web
	$(MAKE) $(BUILD)/tests/bench_web
	+@$(WEB_MAKE) $(WEB)/tests/bench_web
	@npm install --silent --no-save --prefix $(WEB)/mujoco $(MUJOCO_WEB) || echo 'bench-web: without MuJoCo' >&2
	@node --no-warnings tests/bench_web.mjs $(BUILD)/tests/bench_web $(WEB)/tests/bench_web $$(ls -d $(WEB)/mujoco/node_modules/@mujoco/mujoco 2>/dev/null)
bench-schedule: $(PROGRAM) $(BUILD)/tests/bench_schedule
	@mkdir -p results
	$(MPI_ENVIRONMENT) mpirun -n $(CORES) bin/stance run --force scenarios/basin_one_foot.yaml
	$(BUILD)/tests/bench_schedule results/basin_one_foot.h5
profile: $(PROGRAM)
	@$(MAKE) packages-bench || echo 'profile: what needs $(PACKAGES_BENCH) and is missing is skipped' >&2
	@$(TEST_ENVIRONMENT) bash tests/profile.sh

lint: packages-test
	@+bash tests/lint.sh

# The kernels of one lane by clang, which ends them at what depends on memory that nothing was written to.
MEMORY = -O1 -g -fsanitize=memory
golden-memory: packages-test
	+@$(MAKE) BUILD=$(BUILD)/memory CC=clang ISAS=scalar SCALAR_METHODS= LIBRARY_CFLAGS= GOLDEN_LIBS=-lm WARNINGS=-w \
	    CFLAGS='$(MEMORY)' TEST_CFLAGS='$(MEMORY)' KERNEL_CFLAGS='$(MEMORY)' golden
	$(BUILD)/memory/tests/golden 10

# Full debugging information of instrumented kernels takes gcc minutes each.
sanitize: golden-memory
	+STANCE_SLOW=1 $(MAKE) BUILD=build/sanitize PROGRAM=build/sanitize/bin/stance CFLAGS='-O1 -g' KERNEL_CFLAGS='-O1 -g1' \
	    SANITIZE='-fsanitize=address,undefined -fno-sanitize-recover=undefined' FUZZ_CC=none check

STAGE = $(BUILD)/stage
install: $(PROGRAM) $(archives)
	@bash runner/install/stage.sh $(PROGRAM) $(BUILD) $(STAGE) '$(PREFIX)' '$(PYTHON)'
	@bash runner/install/put.sh install $(STAGE) '$(DESTDIR)$(PREFIX)'
uninstall:
	@bash runner/install/put.sh uninstall '$(DESTDIR)$(PREFIX)'

clean:
	rm -rf build bin

help:
	@echo 'make            build bin/stance'
	@echo 'make demo       install what is missing, build, map a stability domain, draw it'
	@echo 'make web        the same with pages for the browser: studies to click through, in results/gallery'
	@echo 'make test       install what is missing, build, run a share of every test'
	@echo 'make test-scripts  ... every script, for every instruction set: pages, fuzzing, other machines, too'
	@echo 'make test-long  ... and what takes hours: everything at length, sanitizers, kills, other machines (STAGES=)'
	@echo 'make mutations  how many deliberate faults the tests find (ROWS=)'
	@echo 'make hunt       look for numbers that depend on the neighbours (HUNT_CASES= SEED=)'
	@echo 'make test-kills kill runs at random, damage files at random (KILLS= FLIPS= TRUNCATIONS= SEED=)'
	@echo 'make test-neon  install a cross compiler and an emulator, run the kernels for ARM, compare'
	@echo 'make test-web  install clang for WebAssembly, node and a browser, run the kernels there, compare (GOLDEN_CASES=)'
	@echo 'make test-slurm install Slurm, run the batch scripts of scenarios/cluster under one of its own'
	@echo 'make test-hosts run on three hosts (network namespaces), one of them cut off in mid-run'
	@echo 'make bench      speed of kernels and program beside MuJoCo: results/bench.csv and .png'
	@echo 'make truths     every method held to published numbers and closed forms: table, results/truth'
	@echo 'make bench-peers  error against cost beside other simulators that are installed: results/peers'
	@echo 'make bench-web  speed of the kernels as WebAssembly beside native ones and MuJoCo as WebAssembly'
	@echo 'make bench-schedule  how a large job would go on thousands of ranks, simulated'
	@echo 'make profile    what the kernels execute per step: instructions, spills, arithmetic'
	@echo 'make lint       format, clang-tidy, cppcheck, symbol prefixes, include rules'
	@echo 'make sanitize   the tests under the address and undefined-behaviour sanitizers'
	@echo 'make fuzz       damaged scenarios and results files, FUZZ_SECONDS=30 long or FUZZ_RUNS= many'
	@echo 'make install    program, library, Python package, manual pages, completion, schema, scenarios: PREFIX=/usr/local DESTDIR='
	@echo 'make uninstall  removes what install puts there'
	@echo 'make MPI=0      a build for one rank, with serial HDF5 and without MPI'
