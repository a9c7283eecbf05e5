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

# The outer libraries of each program; what it uses of lib/ the linker takes from one archive.
PROGRAMS = roughgen bemcontact debrisgen debrisstat sensorsim bpfilter duet delaynet aopf rwl records layout abrade
roughgen_LIBS = fftw
bemcontact_LIBS = fftw
debrisgen_LIBS = fftw
debrisstat_LIBS = gsl
bpfilter_LIBS = fftw
duet_LIBS = fftw
delaynet_LIBS = cblas gsl
rwl_LIBS = gsl

FFTW_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags fftw3 2>/dev/null)
FFTW_LIBS ?= $(shell $(PKG_CONFIG) --libs fftw3 2>/dev/null || echo -lfftw3)
GSL_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags gsl 2>/dev/null)
GSL_LIBS ?= $(shell $(PKG_CONFIG) --libs gsl 2>/dev/null || echo -lgsl -lgslcblas)
# OpenBLAS where its development files are, else GSL's own CBLAS.
ifeq ($(shell $(PKG_CONFIG) --exists openblas 2>/dev/null && echo yes),yes)
CBLAS_LIBS ?= $(shell $(PKG_CONFIG) --libs openblas)
BLAS_FLAG = -DWITH_OPENBLAS
endif
CBLAS_LIBS ?= -lgslcblas
cblas_LINK = $(CBLAS_LIBS)
fftw_LINK = $(FFTW_LIBS)
gsl_LINK = $(GSL_LIBS)

ALL_CFLAGS = $(STD) $(WARN) $(CFLAGS) -pthread
ALL_CPPFLAGS = -Ilib -Isrc -DWEARPIPE_VERSION='"$(VERSION)"' $(BLAS_FLAG) $(FFTW_CFLAGS) $(GSL_CFLAGS) $(CPPFLAGS)

# A program is listed from the moment its folder is there.
BUILT := $(foreach p,$(PROGRAMS),$(if $(wildcard src/$(p)/main.c),$(p)))
CLI_SRC := $(wildcard lib/cli/*.c lib/io/*.c)
LIB_SRC := $(filter-out $(CLI_SRC),$(wildcard lib/*/*.c lib/*/*/*.c))
COMMON_SRC := $(wildcard src/common/*.c)

# Where a library is missing, the archive goes without the modules that include it, so
# that programs which do not need it still build.
missing = $(if $(shell echo '\#include <$(1)>' | $(CC) $(ALL_CPPFLAGS) -E - >/dev/null 2>&1 && echo yes),,$(1))
MISSING := $(strip $(foreach h,fftw3.h gsl/gsl_cblas.h,$(call missing,$(h))))
ifneq ($(MISSING),)
lacks = $(shell $(CC) $(ALL_CPPFLAGS) -MM -MG $(1) | grep -q $(MISSING:%=-e %) && echo $(1))
LIB_SRC := $(filter-out $(foreach f,$(LIB_SRC),$(call lacks,$(f))),$(LIB_SRC))
COMMON_SRC := $(filter-out $(foreach f,$(COMMON_SRC),$(call lacks,$(f))),$(COMMON_SRC))
endif
objects = $(patsubst %.c,$(B)/%.o,$(1))

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
$(BIN)/$(1): $(call objects,$(wildcard src/$(1)/*.c)) $(B)/libcommon.a $(B)/libshell.a $(B)/libwearpipe.a
	@mkdir -p $(BIN)
	$$(CC) $$(ALL_CFLAGS) $$(LDFLAGS) -o $$@ $$^ $$(foreach l,$($(1)_LIBS),$$($$(l)_LINK)) -lm
endef
$(foreach p,$(PROGRAMS),$(eval $(call program,$(p))))

$(B)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CPPFLAGS) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

define archive
$(B)/$(1): $(call objects,$(2))
	@rm -f $$@
	$$(AR) rcs $$@ $$^
endef
$(eval $(call archive,libwearpipe.a,$(LIB_SRC)))
$(eval $(call archive,libshell.a,$(CLI_SRC)))
$(eval $(call archive,libcommon.a,$(COMMON_SRC)))

# Unit tests, long tests and benchmarks in C: one file each, linked with everything.
define single
$(B)/$(1)/%: $(B)/tests/$(1)/%.o $(B)/libshell.a $(B)/libwearpipe.a
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
DOMAINS = num surface contact stress debris stats signal net life layout abrasion count
HEADERS = $(sort $(filter $(DOMAINS:%=lib/%/%.h),$(shell $(CC) $(ALL_CPPFLAGS) -MM src/*/*.c)))
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
