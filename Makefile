# dm2: discrete element modelling on a cluster of workstations.
# `make` builds the five programs into bin/, `make test` runs every test, `make help` lists the rest.

FLAVOUR ?= release
PREFIX  ?= /usr/local
DESTDIR ?=
ifeq ($(origin CC),default)
CC      := gcc
endif

# What every object needs, whatever the user asks for. Arithmetic without contraction is part of the promise of
# the same bits (docs/architecture.md): it comes behind the user's CFLAGS, where it cannot be undone.
DM2_CFLAGS := -std=c11 -D_POSIX_C_SOURCE=200809L -Iinclude -fno-math-errno -MMD -MP
EXACT      := -ffp-contract=off
# Files beyond 2 GiB where a long has 32 bits; elsewhere the macro would only rename open.
ifeq ($(shell echo __SIZEOF_LONG__ | $(CC) $(CFLAGS) -E -P -x c - 2>/dev/null | tail -n 1),4)
DM2_CFLAGS += -D_FILE_OFFSET_BITS=64
endif
WARN := -Wall -Wextra -Wpedantic -Wshadow -Wvla -Wstrict-prototypes -Wmissing-prototypes \
        -Wwrite-strings -Wconversion -Wno-sign-conversion -Wundef -Wpointer-arith \
        -Werror=implicit-function-declaration -Werror=implicit-int -Werror=int-conversion
WERROR ?=
LDLIBS := -lm

ifeq ($(FLAVOUR),release)
CFLAGS ?= -O3 -g
else ifeq ($(FLAVOUR),debug)
CFLAGS ?= -O1 -g3
DM2_CFLAGS += -DDM2_DEBUG
else ifeq ($(FLAVOUR),asan)
CFLAGS ?= -O1 -g3
DM2_CFLAGS += -DDM2_DEBUG -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
LDSAN := -fsanitize=address,undefined
else ifeq ($(FLAVOUR),tsan)
CFLAGS ?= -O1 -g3
DM2_CFLAGS += -fsanitize=thread
LDSAN := -fsanitize=thread
else
$(error FLAVOUR is one of release debug asan tsan, not '$(FLAVOUR)')
endif

# What the compiler, as called with the user's flags, says of itself. The vectorizers of gcc fuse a product and a
# sum in spite of -ffp-contract=off where the processor can. A part of -ffast-math that gcc knows ends in #error
# (base/exact_build.h); clang has no macro for two of them, and undoes both. The x87 unit of a 32-bit x86 rounds
# to more than a double.
MACROS := $(shell echo | $(CC) $(CPPFLAGS) $(CFLAGS) -dM -E -x c - 2>/dev/null)
ifneq ($(filter __FMA__ __FMA4__ __AVX512F__ __ARM_FEATURE_FMA __FP_FAST_FMA,$(MACROS)),)
EXACT += -fno-tree-vectorize -fno-tree-slp-vectorize $(if $(filter __clang__,$(MACROS)),,-fno-tree-loop-vectorize)
endif
ifneq ($(filter __clang__,$(MACROS)),)
EXACT += -fno-associative-math -fno-reciprocal-math
endif
ifneq ($(filter __i386__,$(MACROS)),)
EXACT += -msse2 -mfpmath=sse
endif

ifneq ($(V),1)
Q := @
endif

BUILD    := build/$(FLAVOUR)
# Only the release flavour fills bin/; the others keep their programs beside their objects.
BIN      ?= $(if $(filter release,$(FLAVOUR)),bin,$(BUILD)/bin)
LAYERS   := base deck engine output net cluster performance plot
LIB_SRC  := $(foreach l,$(LAYERS),$(wildcard src/$(l)/*.c))
LIB_OBJ  := $(LIB_SRC:%.c=$(BUILD)/%.o)
APP_SRC  := $(wildcard src/app/*.c)
PROGRAMS := $(patsubst src/app/%.c,$(BIN)/%,$(filter src/app/dm2-%.c,$(APP_SRC)))
APP_OBJ  := $(patsubst %.c,$(BUILD)/%.o,$(filter-out src/app/dm2-%.c,$(APP_SRC)))
TEST_SRC := $(wildcard tests/unit/test_*.c)
TESTS    := $(TEST_SRC:tests/unit/%.c=$(BUILD)/tests/%)
TOOL_SRC := $(wildcard tests/tools/*.c)
TOOLS    := $(TOOL_SRC:tests/tools/%.c=$(BUILD)/tools/%)

FUZZ_SRC := $(wildcard tests/fuzz/fuzz_*.c)
FUZZED   := $(FUZZ_SRC:tests/fuzz/%.c=$(BUILD)/fuzz/replay_%)
FAILING  := $(patsubst src/app/%.c,$(BUILD)/failing/%,$(filter src/app/dm2-%.c,$(APP_SRC)))

.PHONY: soak fuzz all tests test fingerprint figures bench demo install uninstall clean help FORCE
.SUFFIXES:
.SECONDARY:

all: $(PROGRAMS)

tests: $(TESTS) $(TOOLS) $(FUZZED) $(FAILING) $(patsubst %,$(BUILD)/failing/%-server,losing slow spoiling forging ending)

test: all tests
	$(Q)CC='$(CC)' DM2_BIN=$(abspath $(BIN)) DM2_BUILD=$(abspath $(BUILD)) FLAVOUR=$(FLAVOUR) \
		sh tests/run.sh $(TESTFLAGS)

# Runs through faults, 500 unless SOAKFLAGS says otherwise; SOAKFLAGS="-s SEED -n FAULTS".
soak: all tests
	$(Q)DM2_BIN=$(abspath $(BIN)) DM2_BUILD=$(abspath $(BUILD)) DM2_SRC=$(CURDIR) FLAVOUR=$(FLAVOUR) \
		sh tests/soak.sh $(SOAKFLAGS)

figures: all
	$(Q)DM2_BIN=$(BIN) sh scripts/figures.sh $(FIGURES)

# The fingerprint of this release, after a change of results (docs/contributing.md).
fingerprint:
	$(Q)CC='$(CC)' sh scripts/fingerprint.sh

demo: all
	$(Q)DM2_BIN=$(BIN) DM2_BUILD=build sh scripts/demo.sh

# A changed compiler or flag rebuilds everything.
FLAGS_NOW := $(CC) $(DM2_CFLAGS) $(WARN) $(WERROR) $(CPPFLAGS) $(CFLAGS) $(EXACT) $(LDFLAGS)
$(BUILD)/flags: FORCE
	$(Q)mkdir -p $(@D); echo '$(FLAGS_NOW)' | cmp -s - $@ || echo '$(FLAGS_NOW)' > $@

# The directory of the installed decks and materials; a changed PREFIX rebuilds what has it compiled in.
$(BUILD)/prefix: FORCE
	$(Q)mkdir -p $(@D); echo '$(PREFIX)' | cmp -s - $@ || echo '$(PREFIX)' > $@
$(BUILD)/src/app/places.o: $(BUILD)/prefix
$(BUILD)/src/app/places.o: DM2_CFLAGS += -DDM2_SHARE='"$(PREFIX)/share/dm2"'

$(BUILD)/%.o: %.c $(BUILD)/flags
	$(Q)mkdir -p $(@D)
	$(if $(Q),@echo "  CC   $<")
	$(Q)$(CC) $(DM2_CFLAGS) $(WARN) $(WERROR) $(CPPFLAGS) $(CFLAGS) $(EXACT) -c -o $@ $<

$(BUILD)/libdm2.a: $(LIB_OBJ) $(APP_OBJ)
	$(Q)rm -f $@; ar rcs $@ $^

$(BIN)/%: $(BUILD)/src/app/%.o $(BUILD)/libdm2.a
	$(Q)mkdir -p $(@D)
	$(if $(Q),@echo "  LINK $@")
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/tests/%: $(BUILD)/tests/unit/%.o $(BUILD)/libdm2.a
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/tools/%: $(BUILD)/tests/tools/%.o $(BUILD)/libdm2.a
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# Functions that a target has in place of the library's.
$(BUILD)/fuzz/replay_fuzz_client $(BUILD)/fuzz_client: FUZZ_WRAP := -Wl,--wrap=socket_connect -Wl,--wrap=auth_nonce
$(BUILD)/fuzz/replay_fuzz_session $(BUILD)/fuzz_session: FUZZ_WRAP := -Wl,--wrap=auth_nonce

$(BUILD)/fuzz/replay_%: $(BUILD)/tests/fuzz/%.o $(BUILD)/tests/fuzz/replay.o $(BUILD)/libdm2.a
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) $(FUZZ_WRAP) -o $@ $^ $(LDLIBS)

# Servers with a fault or a slow engine of their own (tests/failing/losing.c, slow.c, spoiling.c, forging.c,
# ending.c).
$(BUILD)/failing/losing-server: WRAP = subdomain_owned
$(BUILD)/failing/slow-server: WRAP = pulse_beat
$(BUILD)/failing/spoiling-server: WRAP = subdomain_pack_update
$(BUILD)/failing/forging-server: WRAP = subdomain_sort_out
$(BUILD)/failing/ending-server: WRAP = subdomain_forces
$(BUILD)/failing/%-server: $(BUILD)/src/app/dm2-server.o $(BUILD)/tests/failing/%.o $(BUILD)/libdm2.a
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) -Wl,--wrap=$(WRAP) -o $@ $^ $(LDLIBS)

# Programs whose system calls fail when they are told to (tests/failing/failing.c).
WRAPPED := malloc calloc realloc posix_memalign open write fsync rename link fcntl read writev poll socket accept connect pipe fork
$(BUILD)/failing/%: $(BUILD)/src/app/%.o $(BUILD)/tests/failing/failing.o $(BUILD)/libdm2.a
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) $(WRAPPED:%=-Wl,--wrap=%) -o $@ $^ $(LDLIBS)

# The targets as libFuzzer programs, where clang has it: build/libfuzzer/fuzz_NAME [option...] DIRECTORY
fuzz:
	$(Q)$(MAKE) CC=clang BUILD=build/libfuzzer BIN=build/libfuzzer/bin LDSAN=-fsanitize=fuzzer \
		CFLAGS='-O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all' \
		$(FUZZ_SRC:tests/fuzz/%.c=build/libfuzzer/%)

$(BUILD)/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.o $(BUILD)/libdm2.a
	$(Q)$(CC) $(CFLAGS) $(LDSAN) $(LDFLAGS) $(FUZZ_WRAP) -o $@ $^ $(LDLIBS)

# The private headers of src/LAYER are for their layer and for tests.
$(BUILD)/tests/%.o: DM2_CFLAGS += -Isrc -Itests/unit

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

bench: all
	$(Q)DM2_BIN=$(abspath $(BIN)) sh scripts/bench.sh $(BENCHFLAGS)

install: all
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/share/dm2/input
	install -m 755 $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin
	cp -R input/. $(DESTDIR)$(PREFIX)/share/dm2/input

uninstall:
	rm -f $(patsubst $(BIN)/%,$(DESTDIR)$(PREFIX)/bin/%,$(PROGRAMS))
	rm -rf $(DESTDIR)$(PREFIX)/share/dm2

clean:
	rm -rf build bin

help:
	@echo 'make               the programs, into bin/'
	@echo 'make test          every test; TESTFLAGS="-L unit" or "-R regex" picks some'
	@echo 'make soak          runs through 500 faults; SOAKFLAGS="-s 1 -n 500": first seed, faults'
	@echo 'make fuzz          the fuzz targets of tests/fuzz as libFuzzer programs (clang)'
	@echo 'make demo          the plate impact on 4 local servers, with its picture'
	@echo 'make bench         speed per core, beside LAMMPS where it is installed; BENCHFLAGS="3 lj"'
	@echo 'make figures       the figures of the timing study; FIGURES=measure measures first'
	@echo '                   (30 minutes, as root), FIGURES=sweep without the emulated cluster (4),'
	@echo '                   FIGURES=accuracy the error of the model alone'
	@echo 'make fingerprint   the constant of engine/self_test.h, after a change of results'
	@echo 'make install       into PREFIX (/usr/local), below DESTDIR; make uninstall'
	@echo 'make clean         removes build/ and bin/'
	@echo 'FLAVOUR=release|debug|asan|tsan   CC=gcc|clang   CFLAGS=...   V=1'
