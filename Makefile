# stance: build, test, demonstrate. `make help` lists the targets.
.DEFAULT_GOAL := all
BUILD  ?= build
PREFIX ?= /usr/local
CC      = gcc
MPI    ?= 1
CFLAGS ?= -O2 -g

WARNINGS  = -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Werror
STRICT    = -std=c17 -D_GNU_SOURCE -ffp-contract=off -fno-math-errno -fno-trapping-math
ALLFLAGS  = $(CFLAGS) $(STRICT) $(WARNINGS) $(SANITIZE)

include packages.mk

# ---- the engine: a library without MPI, HDF5, YAML, files or terminals ------------------------
SCENES  = biped
METHODS = implicit midpoint
MACHINE := $(shell uname -m)
ifeq ($(MACHINE),x86_64)
ISAS    = scalar sse2 avx2 avx512
endif
ifeq ($(MACHINE),aarch64)
ISAS    = scalar neon
endif
ISAS   ?= scalar
isa_flags_scalar = -DSTANCE_LANES=1
isa_flags_sse2   = -DSTANCE_LANES=2
isa_flags_neon   = -DSTANCE_LANES=2
isa_flags_avx2   = -DSTANCE_LANES=4 -mavx2
isa_flags_avx512 = -DSTANCE_LANES=8 -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512

kernels := $(foreach s,$(SCENES),$(foreach m,$(METHODS),$(foreach i,$(ISAS),$(s)-$(m)-$(i))))
kernel_objects := $(kernels:%=$(BUILD)/kernel/%.o)
engine_sources := $(wildcard engine/*.c engine/control/*.c engine/scenes/*.c)
engine_objects := $(engine_sources:%.c=$(BUILD)/%.o) $(kernel_objects)
isa_list = -DSTANCE_ISA_LIST='$(foreach i,$(ISAS),X($(i)))'

# ---- the program ------------------------------------------------------------------------------
program_sources := $(wildcard runner/*.c analysis/*.c)
program_objects := $(program_sources:%.c=$(BUILD)/%.o)

REVISION := $(shell git describe --always --dirty --abbrev=12 2>/dev/null || echo unknown)
BUILD_INFO = -DSTANCE_REVISION='"$(REVISION)"' \
             -DSTANCE_COMPILER='"$(shell $(CC) --version | head -n 1)"' \
             -DSTANCE_CFLAGS='"$(CFLAGS) $(STRICT)"'

.PHONY: all install clean help
all: bin/stance

bin/stance: $(program_objects) $(BUILD)/libstance.a
	@mkdir -p $(@D)
	$(LINK) -o $@ $^ $(LDFLAGS) $(LIBS)

$(BUILD)/libstance.a: $(engine_objects)
	rm -f $@ && ar rcs $@ $^

define kernel_rule
$(BUILD)/kernel/$(1)-$(2)-$(3).o: engine/methods/$(2).c
	@mkdir -p $$(@D)
	$$(CC) $$(ALLFLAGS) $$(isa_flags_$(3)) -DSTANCE_SCENE=$(1) -DSTANCE_SCENE_LANES='"../scenes/$(1)_lanes.h"' -DSTANCE_ISA=$(3) -MMD -c -o $$@ $$<
endef
$(foreach s,$(SCENES),$(foreach m,$(METHODS),$(foreach i,$(ISAS),\
$(eval $(call kernel_rule,$(s),$(m),$(i))))))

$(BUILD)/engine/%.o: engine/%.c
	@mkdir -p $(@D)
	$(CC) $(ALLFLAGS) $(isa_list) $(LAPACK_CFLAGS) -MMD -c -o $@ $<
$(BUILD)/runner/%.o: runner/%.c
	@mkdir -p $(@D)
	$(CC) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -c -o $@ $<
$(BUILD)/analysis/%.o: analysis/%.c
	@mkdir -p $(@D)
	$(CC) $(ALLFLAGS) $(PROGRAM_CFLAGS) -MMD -c -o $@ $<
# What the build was is recorded in one object, made anew when the revision changes.
$(BUILD)/runner/build_info.o: ALLFLAGS += $(BUILD_INFO)
$(BUILD)/revision: FORCE
	@mkdir -p $(@D); echo '$(REVISION)' | cmp -s - $@ || echo '$(REVISION)' > $@
$(BUILD)/runner/build_info.o: $(BUILD)/revision
FORCE:

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

clean:
	rm -rf $(BUILD) bin
