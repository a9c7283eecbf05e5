# wearpipe: remaining wear life of hydraulic pumps from the debris they shed
#
#	make              build all programs into bin/
#	make demo         install or name what is missing, build, run the whole pipeline
#	make check        build and run the tests
#	make install      PREFIX and DESTDIR as usual
#
# The other targets are listed by "make help".

VERSION = 0.1.0
PREFIX ?= /usr/local
CC ?= cc
AR ?= ar
PKG_CONFIG ?= pkg-config
CFLAGS ?= -O2 -g

# -ffp-contract=off: the same bytes from every build of one compiler.
STD = -std=c11 -D_XOPEN_SOURCE=700 -ffp-contract=off
WARN = -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes
B = build
BIN = bin

# What each program is made of besides lib/shell: modules of lib/ and libraries.
PROGRAMS = roughgen bemcontact debrisgen debrisstat sensorsim bpfilter duet aopf rwl rec

roughgen_MODULES = num/philox num/fft
roughgen_LIBS = fftw
bemcontact_MODULES = num/pool num/fft
bemcontact_LIBS = fftw
debrisgen_MODULES = num/pool num/fft
debrisgen_LIBS = fftw
debrisstat_MODULES = num/philox num/rng
debrisstat_LIBS = gsl
sensorsim_MODULES = num/philox signal/sensor signal/scene
sensorsim_LIBS =
bpfilter_MODULES = num/fft signal/fir
bpfilter_LIBS = fftw
duet_MODULES = num/fft
duet_LIBS = fftw gsl
aopf_MODULES = num/philox num/rng
aopf_LIBS = gsl
rwl_MODULES = num/philox num/rng
rwl_LIBS = gsl
rec_MODULES =
rec_LIBS =

FFTW_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags fftw3 2>/dev/null)
FFTW_LIBS ?= $(shell $(PKG_CONFIG) --libs fftw3 2>/dev/null || echo -lfftw3)
GSL_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags gsl 2>/dev/null)
GSL_LIBS ?= $(shell $(PKG_CONFIG) --libs gsl 2>/dev/null || echo -lgsl -lgslcblas)
fftw_LINK = $(FFTW_LIBS)
gsl_LINK = $(GSL_LIBS)

ALL_CFLAGS = $(STD) $(WARN) $(CFLAGS) -pthread
CPPFLAGS += -Ilib -DWEARPIPE_VERSION='"$(VERSION)"' $(FFTW_CFLAGS) $(GSL_CFLAGS)

# A program is listed from the moment its source is there.
BUILT := $(foreach p,$(PROGRAMS),$(if $(wildcard src/$(p).c),$(p)))
SHELL_OBJS := $(patsubst lib/%.c,$(B)/lib/%.o,$(wildcard lib/shell/*.c))
LIB_OBJS := $(patsubst lib/%.c,$(B)/lib/%.o,$(sort $(wildcard lib/num/*.c lib/contact/*.c lib/signal/*.c lib/life/*.c)))
UNITS := $(patsubst tests/unit/%.c,$(B)/unit/%,$(wildcard tests/unit/*.c))
LONG_UNITS := $(patsubst tests/long/%.c,$(B)/long/%,$(wildcard tests/long/*.c))
BENCH_BINS := $(patsubst tests/bench/%.c,$(B)/bench/%,$(wildcard tests/bench/*.c))

.PHONY: all check check-long bench lint asan fuzz demo install uninstall dist clean help
.SECONDARY:
.DELETE_ON_ERROR:

all: libraries $(BUILT:%=$(BIN)/%)

.PHONY: libraries
libraries:
	@PKG_CONFIG="$(PKG_CONFIG)" scripts/deps --check

define program
$(BIN)/$(1): $(B)/src/$(1).o $(SHELL_OBJS) $($(1)_MODULES:%=$(B)/lib/%.o)
	@mkdir -p $(BIN)
	$$(CC) $$(ALL_CFLAGS) $$(LDFLAGS) -o $$@ $$^ $$(foreach l,$($(1)_LIBS),$$($$(l)_LINK)) -lm
endef
$(foreach p,$(PROGRAMS),$(eval $(call program,$(p))))

$(B)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

$(B)/libwearpipe.a: $(LIB_OBJS)
	@rm -f $@
	$(AR) rcs $@ $^

$(B)/libshell.a: $(SHELL_OBJS)
	@rm -f $@
	$(AR) rcs $@ $^

# Unit tests, long tests and benchmarks in C: one file each, linked with everything.
define single
$(B)/$(1)/%: $(B)/tests/$(1)/%.o $(B)/libwearpipe.a $(B)/libshell.a
	@mkdir -p $$(@D)
	$$(CC) $$(ALL_CFLAGS) $$(LDFLAGS) -o $$@ $$^ $$(FFTW_LIBS) $$(GSL_LIBS) -lm
endef
$(foreach d,unit long bench,$(eval $(call single,$(d))))

check: all $(UNITS)
	@BIN=$(abspath $(BIN)) tests/run tests/*.t tests/extremes/*.t $(UNITS)

check-long: all $(LONG_UNITS)
	@BIN=$(abspath $(BIN)) tests/run tests/long/*.t $(LONG_UNITS)

# make bench, or one domain: make bench-contact
bench: $(patsubst tests/bench/%.sh,bench-%,$(wildcard tests/bench/*.sh))
bench-%: all $(BENCH_BINS)
	@sh tests/bench/$*.sh

# The table of extreme scenes of one domain: make extremes-contact
extremes-%: all
	@sh tests/extremes/$*.t | sed -n 's/^\(not ok\|ok\) [0-9]* - /\1 | /p'

lint: all
	@scripts/lint

asan:
	ASAN_OPTIONS=detect_leaks=0 $(MAKE) B=build/asan BIN=build/asan/bin check \
		CFLAGS='-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer'

fuzz:
	@scripts/fuzz

demo:
	@scripts/deps
	@$(MAKE) all
	@$(MAKE) -C examples/demo SURFACE=$(SURFACE)

clean:
	rm -rf bin build

-include $(shell find $(B) -name '*.d' 2>/dev/null)
