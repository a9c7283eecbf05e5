# wearpipe: remaining wear life of hydraulic pumps from the debris they shed
#
#	make              build all programs into bin/
#	make demo         install or name what is missing, build, run the whole pipeline
#	make check        build and run the tests
#	make install      PREFIX and DESTDIR as usual
#
#	make bin/duet     one program alone, with the libraries it needs and no others
#	make check-long   the longer checks; make check-all: both
#	make bench        error against run time; one domain: make bench-contact
#	make extremes-contact  the table of extreme scenes of a domain
#	make lint asan fuzz    linters, sanitizers, fuzzers
#	make uninstall dist clean

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

# What each program is made of besides lib/shell: parts of src/ that programs share,
# modules of lib/ and libraries.
PROGRAMS = roughgen bemcontact debrisgen debrisstat sensorsim bpfilter duet delaynet aopf rwl records

roughgen_PARTS = generated measured raw roughness
roughgen_MODULES = num/philox num/fft num/pool surface/areal surface/heights surface/rough surface/spectrum surface/surface
roughgen_LIBS = fftw
bemcontact_PARTS = press raw
bemcontact_MODULES = contact/kernel contact/solver contact/bccg contact/grids contact/mlms contact/pk num/convolve num/fft num/pool num/sweep
bemcontact_LIBS = fftw
debrisgen_PARTS = press wearing worn
debrisgen_MODULES = $(bemcontact_MODULES) num/room debris/chords debris/debris debris/hull stress/influence debris/particles stress/stress \
	stress/stress_direct stress/stress_fourier stress/stress_kernel surface/surface num/sym3 debris/tally debris/wear stress/window
debrisgen_LIBS = fftw
debrisstat_MODULES = num/philox num/room stats/ensemble stats/estimates stats/statistics
debrisstat_LIBS = gsl
sensorsim_PARTS = sensors source
sensorsim_MODULES = num/philox num/normals num/ziggurat signal/sensor signal/passage signal/scene
sensorsim_LIBS =
bpfilter_MODULES = num/fft num/select signal/fir signal/lines signal/tones signal/robust
bpfilter_LIBS = fftw
duet_PARTS = found instrument methods
duet_MODULES = num/fft num/select signal/sensor signal/shape signal/joint signal/joint_model signal/joint_step signal/joint_moves signal/align signal/robust signal/tones signal/sections signal/calibrate signal/measure signal/matched signal/learn signal/examples signal/correct signal/whiten signal/colour signal/quiet signal/fir signal/stft signal/masks signal/count signal/separate signal/judge signal/tape signal/campbell net/cnn net/network net/netfile num/philox
duet_LIBS = fftw cblas
delaynet_PARTS = learning lessons scores
delaynet_MODULES = num/philox net/lesson net/training net/network net/network_gradient net/netfile net/delaydata net/delayloss net/cnn net/cnndata signal/sensor
delaynet_LIBS = cblas gsl
aopf_PARTS = filtering levels outlook timeunit
aopf_MODULES = num/philox num/select num/ziggurat life/draw life/resample life/filter life/grey life/order life/noise life/adaptive life/history life/damage life/fleet life/runin life/predict life/metrics
aopf_LIBS =
rwl_PARTS = fragments levels lifetable pump state timeunit
rwl_MODULES = num/philox num/rng num/room num/select life/forecast life/grey life/leakage life/metrics life/noise life/observed life/pair life/partition life/paths life/rate life/remaining life/slope
rwl_LIBS = gsl
records_PARTS = raw
records_MODULES =
records_LIBS =

FFTW_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags fftw3 2>/dev/null)
FFTW_LIBS ?= $(shell $(PKG_CONFIG) --libs fftw3 2>/dev/null || echo -lfftw3)
GSL_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags gsl 2>/dev/null)
GSL_LIBS ?= $(shell $(PKG_CONFIG) --libs gsl 2>/dev/null || echo -lgsl -lgslcblas)
# OpenBLAS where its development files are, else GSL's own CBLAS.
ifeq ($(shell $(PKG_CONFIG) --exists openblas 2>/dev/null && echo yes),yes)
CBLAS_LIBS ?= $(shell $(PKG_CONFIG) --libs openblas)
CPPFLAGS += -DWITH_OPENBLAS
endif
CBLAS_LIBS ?= -lgslcblas
cblas_LINK = $(CBLAS_LIBS)
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

.PHONY: all check check-long check-all bench lint asan fuzz demo install uninstall dist clean help
.SECONDARY:
.DELETE_ON_ERROR:

all: libraries $(BUILT:%=$(BIN)/%)

.PHONY: libraries
libraries:
	@PKG_CONFIG="$(PKG_CONFIG)" scripts/deps --check

define program
$(BIN)/$(1): $(B)/src/$(1).o $($(1)_PARTS:%=$(B)/src/%.o) $(SHELL_OBJS) $($(1)_MODULES:%=$(B)/lib/%.o)
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

TESTS = tests/*.t tests/extremes/*.t $(UNITS)
LONG_TESTS = tests/long/*.t $(LONG_UNITS)

check: all $(UNITS)
	@BIN=$(abspath $(BIN)) tests/run $(TESTS)

check-long: all $(LONG_UNITS) $(BENCH_BINS)
	@BIN=$(abspath $(BIN)) tests/run $(LONG_TESTS)

check-all: all $(UNITS) $(LONG_UNITS) $(BENCH_BINS)
	@BIN=$(abspath $(BIN)) tests/run $(TESTS) $(LONG_TESTS)

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
	ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 \
		$(MAKE) B=build/asan BIN=build/asan/bin check \
		CFLAGS='-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all'

# Needs clang; SECONDS for each target.
SECONDS = 30
fuzz:
	@scripts/fuzz $(SECONDS)

# A measured surface instead of a generated one: make demo SURFACE=file
demo:
	@scripts/deps
	@$(MAKE) --no-print-directory all
	@$(MAKE) --no-print-directory -C examples/demo BIN=$(abspath $(BIN)) SURFACE="$(abspath $(SURFACE))"

$(B)/wearpipe.bash: $(BUILT:%=$(BIN)/%) scripts/completion
	@scripts/completion $(BUILT:%=$(BIN)/%) >$@

# The library's interface is what the programs call: the headers they include, and what
# those include.
DOMAINS = num contact signal life
HEADERS = $(sort $(filter $(DOMAINS:%=lib/%/%.h),$(shell $(CC) $(CPPFLAGS) -MM src/*.c)))
MAN1 = $(wildcard man/*.1)
D = $(DESTDIR)$(PREFIX)

install: all $(B)/libwearpipe.a $(B)/wearpipe.bash
	install -d $(D)/bin $(D)/lib/pkgconfig $(D)/share/man/man1 $(D)/share/man/man5 \
		$(D)/share/man/man7 $(D)/share/bash-completion/completions $(D)/share/wearpipe \
		$(DOMAINS:%=$(D)/include/wearpipe/%)
	install $(BUILT:%=$(BIN)/%) $(D)/bin
	install -m 644 $(B)/libwearpipe.a $(D)/lib
	for h in $(HEADERS:lib/%=%); do install -m 644 lib/$$h $(D)/include/wearpipe/$$h || exit; done
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' wearpipe.pc.in \
		>$(D)/lib/pkgconfig/wearpipe.pc
	install -m 644 $(MAN1) $(D)/share/man/man1
	install -m 644 man/wearpipe-streams.5 $(D)/share/man/man5
	install -m 644 man/wearpipe.7 $(D)/share/man/man7
	install -m 644 share/arrivals.net $(D)/share/wearpipe
	install -m 644 $(B)/wearpipe.bash $(D)/share/bash-completion/completions/wearpipe
	for p in $(BUILT); do ln -sf wearpipe $(D)/share/bash-completion/completions/$$p || exit; done

uninstall:
	rm -f $(BUILT:%=$(D)/bin/%) $(D)/lib/libwearpipe.a $(D)/lib/pkgconfig/wearpipe.pc \
		$(MAN1:man/%=$(D)/share/man/man1/%) $(D)/share/man/man5/wearpipe-streams.5 \
		$(D)/share/man/man7/wearpipe.7 $(D)/share/bash-completion/completions/wearpipe \
		$(BUILT:%=$(D)/share/bash-completion/completions/%)
	rm -rf $(D)/include/wearpipe $(D)/share/wearpipe

dist:
	git archive --prefix=wearpipe-$(VERSION)/ -o wearpipe-$(VERSION).tar.gz HEAD

help:
	@sed -n 's/^#\t/  /p; /^PROGRAMS/q' Makefile

clean:
	rm -rf build bin

-include $(shell find $(B) -name '*.d' 2>/dev/null)
