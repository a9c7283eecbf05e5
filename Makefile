# wearpipe: remaining wear life of hydraulic pumps from the debris they shed
#
#	make              build all programs into bin/
#	make demo         install or name what is missing, build, run the whole pipeline
#	make check        build and run the tests
#	make install      PREFIX or prefix, DESTDIR, BINDIR, LIBDIR, INCLUDEDIR, DATADIR, MANDIR, DOCDIR
#
#	make bin/duet     one program alone, with the libraries it needs and no others
#	make check-long   the longer checks; make check-all: both; make check-cluster: under Slurm
#	make bench        error against run time; one domain: make bench-contact
#	make extremes-contact  the table of extreme scenes of a domain
#	make thesis       every item of the thesis beside ours, on one page; make thesis-quick
#	make matrix       duet on a matrix of instruments: rows wrong, found, errors, time
#	make lint asan fuzz    linters, sanitizers, fuzzers
#	make uninstall dist clean
#	make V=1          show every command

VERSION = 0.1.0
PREFIX ?= $(or $(prefix),/usr/local)
CC ?= cc
AR ?= ar
PKG_CONFIG ?= pkg-config
CFLAGS ?= -O2 -g

BINDIR ?= $(PREFIX)/bin
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DATADIR ?= $(PREFIX)/share
MANDIR ?= $(DATADIR)/man
DOCDIR ?= $(DATADIR)/doc/wearpipe

# The same bytes for every family of processors: no contraction, and no vectors made of
# single operations, where GCC contracts what it was told not to (vfmaddsub in a product of
# complex numbers).  Names are hidden
# but for those that include/wearpipe/ declares.
STD = -std=c11 -D_XOPEN_SOURCE=700 -ffp-contract=off -fno-tree-slp-vectorize -fPIC -fvisibility=hidden
WARN = -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes $(CONVERSION)
CONVERSION = -Wconversion -Wsign-conversion
B = build
BIN = bin
Q = $(if $(V),,@)
say = $(if $(V)$(findstring s,$(firstword -$(MAKEFLAGS))),@:,@printf '  %-4s %s\n' $(1) '$(2)')

# The outer libraries of each program; what it uses of lib/ the linker takes from one archive.
PROGRAMS = roughgen bemcontact debrisgen debrisfit debrisstat sensorsim bpfilter duet delaynet aopf rwl records layout abrade debriscount ballcal surfimport sigconvert wear-volume
roughgen_LIBS = fftw
bemcontact_LIBS = fftw
debrisgen_LIBS = fftw
debrisfit_LIBS = fftw
debrisstat_LIBS = gsl
bpfilter_LIBS = fftw
duet_LIBS = fftw
delaynet_LIBS = cblas gsl
rwl_LIBS = gsl
debriscount_LIBS = gsl
ballcal_LIBS = gsl
sigconvert_LIBS = sndfile

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
# WAV, FLAC and the like, where libsndfile is.
ifeq ($(shell $(PKG_CONFIG) --exists sndfile 2>/dev/null && echo yes),yes)
sndfile_LINK = $(shell $(PKG_CONFIG) --libs sndfile)
SNDFILE_FLAG = -DWITH_SNDFILE $(shell $(PKG_CONFIG) --cflags sndfile)
endif
# Asked once, not for every object.
$(foreach v,FFTW_CFLAGS FFTW_LIBS GSL_CFLAGS GSL_LIBS CBLAS_LIBS sndfile_LINK SNDFILE_FLAG,$(eval $(v) := $($(v))))
cblas_LINK = $(CBLAS_LIBS)
fftw_LINK = $(FFTW_LIBS)
gsl_LINK = $(GSL_LIBS)

# Scripts that users call, built and installed beside the programs.
SCRIPTS = wearplot surfunzip wearwatch

ALL_CFLAGS = $(STD) $(WARN) $(CFLAGS) -pthread
ALL_CPPFLAGS = -Iinclude -Ilib -Isrc -DWEARPIPE_VERSION='"$(VERSION)"' $(BLAS_FLAG) $(SNDFILE_FLAG) $(FFTW_CFLAGS) $(GSL_CFLAGS) $(CPPFLAGS)

# A program is listed from the moment its folder is there.
BUILT := $(foreach p,$(PROGRAMS),$(if $(wildcard src/$(p)/main.c),$(p)))
CLI_SRC := $(wildcard lib/cli/*.c lib/io/*.c)
LIB_SRC := $(filter-out $(CLI_SRC),$(wildcard lib/*/*.c lib/*/*/*.c))
COMMON_SRC := $(wildcard src/common/*.c)

# Where a library is missing, the archive goes without the modules that include it, so
# that programs which do not need it still build.
missing = $(if $(shell $(CC) $(ALL_CPPFLAGS) -include $(1) -x c -E /dev/null >/dev/null 2>&1 && echo yes),,$(1))
MISSING := $(strip $(foreach h,fftw3.h gsl/gsl_cdf.h,$(call missing,$(h))))
ifneq ($(MISSING),)
lacks = $(shell $(CC) $(ALL_CPPFLAGS) -M -MG $(1) | \
	grep -q $(foreach h,$(MISSING),-e '[ /]$(firstword $(subst /,/ ,$(h)))') && echo $(1))
LIB_SRC := $(filter-out $(foreach f,$(LIB_SRC),$(call lacks,$(f))),$(LIB_SRC))
COMMON_SRC := $(filter-out $(foreach f,$(COMMON_SRC),$(call lacks,$(f))),$(COMMON_SRC))
endif
objects = $(patsubst %.c,$(B)/%.o,$(1))

UNITS := $(patsubst tests/unit/%.c,$(B)/unit/%,$(wildcard tests/unit/*.c))
LONG_UNITS := $(patsubst tests/long/%.c,$(B)/long/%,$(wildcard tests/long/*.c))
BENCH_BINS := $(patsubst tests/bench/%.c,$(B)/bench/%,$(wildcard tests/bench/*.c))

.PHONY: check-cluster all check check-long check-all bench lint asan asan-quick fuzz demo install uninstall dist clean help FORCE
.SECONDARY:
.DELETE_ON_ERROR:

all: libraries $(BUILT:%=$(BIN)/%) $(SCRIPTS:%=$(BIN)/%)

.PHONY: libraries
libraries:
	@PKG_CONFIG="$(PKG_CONFIG)" CC="$(CC)" CPPFLAGS="$(FFTW_CFLAGS) $(GSL_CFLAGS) $(CPPFLAGS)" scripts/deps --check

define program
$(BIN)/$(1): $(call objects,$(wildcard src/$(1)/*.c)) $(B)/libcommon.a $(B)/libcli.a $(B)/libwearpipe.a
	@mkdir -p $(BIN)
	$$(call say,LINK,$$@)
	$$(Q)$$(CC) $$(ALL_CFLAGS) $$(LDFLAGS) -o $$@ $$^ $$(foreach l,$($(1)_LIBS),$$($$(l)_LINK)) -lm
endef
$(foreach p,$(PROGRAMS),$(eval $(call program,$(p))))

$(SCRIPTS:%=$(BIN)/%): $(BIN)/%: scripts/% share/page.css
	@mkdir -p $(BIN)
	@sed -e 's/@VERSION@/$(VERSION)/' -e '/^@STYLE@$$/r share/page.css' -e '/^@STYLE@$$/d' $< >$@
	@chmod 755 $@

$(B)/src/records/replay.o: ALL_CPPFLAGS += -DWEARPIPE_PROGRAMS='"$(PROGRAMS)"'
$(B)/src/records/replay.o: Makefile

$(B)/%.o: %.c
	@mkdir -p $(@D)
	$(call say,CC,$<)
	$(Q)$(CC) $(ALL_CPPFLAGS) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

define archive
$(B)/$(1): $(call objects,$(2))
	@rm -f $$@
	$$(call say,AR,$$@)
	$$(Q)$$(AR) rcs $$@ $$^
endef
$(eval $(call archive,libwearpipe.a,$(LIB_SRC)))
$(eval $(call archive,libcli.a,$(CLI_SRC)))
$(eval $(call archive,libcommon.a,$(COMMON_SRC)))

# The library for other programs: the modules that lib/wearpipe/ needs, joined into one
# object whose names are local but for wp_*, as an archive and as a shared object.
# Functions that GCC compiles for several processors are not hidden by -fvisibility.
FACE_SRC := $(wildcard lib/wearpipe/*.c)
SONAME = libwearpipe.so.0
OBJCOPY ?= objcopy
$(B)/face.o: $(call objects,$(FACE_SRC)) $(B)/libwearpipe.a
	$(call say,LD,$@)
	$(Q)$(LD) -r -o $@ $(call objects,$(FACE_SRC)) $(B)/libwearpipe.a
	$(Q)$(OBJCOPY) --wildcard --keep-global-symbol='wp_*' $@
$(B)/install/libwearpipe.a: $(B)/face.o
	@mkdir -p $(@D)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^
$(B)/install/$(SONAME): $(B)/face.o
	@mkdir -p $(@D)
	$(call say,LINK,$@)
	$(Q)$(CC) $(ALL_CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(SONAME) -Wl,-z,defs -o $@ $^ \
		$(FFTW_LIBS) $(GSL_LIBS) -lm
LIBRARY = $(B)/install/libwearpipe.a $(B)/install/$(SONAME)
.PHONY: library
library: $(LIBRARY)

# Unit tests, long tests and benchmarks in C: one file each, linked with everything.
define single
$(B)/$(1)/%: $(B)/tests/$(1)/%.o $(B)/libcli.a $(B)/libwearpipe.a
	@mkdir -p $$(@D)
	$$(call say,LINK,$$@)
	$$(Q)$$(CC) $$(ALL_CFLAGS) $$(LDFLAGS) -o $$@ $$^ $$(FFTW_LIBS) $$(GSL_LIBS) -lm
endef
$(foreach d,unit long bench,$(eval $(call single,$(d))))

# The simulator of the matrix of instruments shares no code with the library.
$(B)/matrix/%: tests/matrix/%.c
	@mkdir -p $(@D)
	$(call say,LINK,$@)
	$(Q)$(CC) $(STD) $(WARN) $(CFLAGS) -o $@ $< -lm
MATRIX = $(B)/matrix/simulate

# The longest first, so that the short ones fill all cores at the end.
TESTS = tests/matrix.t tests/duet.t $(filter-out tests/matrix.t tests/duet.t, \
	$(wildcard tests/*.t)) tests/extremes/*.t $(UNITS)
LONG_TESTS = tests/long/*.t $(LONG_UNITS)

# One more than there are cores, since some tests wait.
check: all $(UNITS) $(MATRIX)
	@BIN="$(abspath $(BIN))" tests/run -j $$(($$(getconf _NPROCESSORS_ONLN) + 1)) $(TESTS)

check-long: all $(UNITS) $(LONG_UNITS) $(BENCH_BINS) $(MATRIX)
	@BIN="$(abspath $(BIN))" tests/run $(LONG_TESTS)

# The long tests come first, so that the short ones fill both cores at the end.
check-all: all $(UNITS) $(LONG_UNITS) $(BENCH_BINS) $(MATRIX)
	@BIN="$(abspath $(BIN))" tests/run $(LONG_TESTS) $(TESTS)

# A Slurm cluster of one node, started for the test; requires slurm-wlm and munge.
check-cluster: all
	@BIN="$(abspath $(BIN))" tests/run tests/cluster/*.t

# make bench, or one domain: make bench-contact
bench: $(patsubst tests/bench/%.sh,bench-%,$(wildcard tests/bench/*.sh))
bench-%: all $(BENCH_BINS)
	@sh tests/bench/$*.sh

# What duet makes of every scene of the matrix of instruments: make matrix SCENE=hum
SCENE = .
.PHONY: matrix
matrix: all $(MATRIX)
	@PATH="$(abspath $(BIN)):$$PATH" tests/matrix/run tests/matrix/scenes.tsv '$(SCENE)'

# The table of extreme scenes of one domain: make extremes-contact
extremes-%: all
	@sh tests/extremes/$*.t | sed -nEf tests/extremes/rows.sed
# Those of the signal include crowded records.
extremes-signal: all
	@{ sh tests/extremes/signal.t; sh tests/long/crowded.t; } | \
		sed -nEf tests/extremes/rows.sed
# Those of the contact include solutions that are known.
extremes-contact: all $(B)/long/exact
	@{ sh tests/extremes/contact.t; $(B)/long/exact; } | \
		sed -nEf tests/extremes/rows.sed

lint: all
	+@scripts/lint

# Address and undefined-behaviour sanitizers on all default tests, or on the unit tests and
# the tests of streams and options alone.
SANITIZED = ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 \
	$(MAKE) --no-print-directory B=build/asan BIN=build/asan/bin \
	CFLAGS='-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all'
asan:
	+@$(SANITIZED) check
asan-quick:
	+@$(SANITIZED) check TESTS='tests/programs.t tests/streams.t tests/tables.t tests/signals.t $$(UNITS)'

# Needs clang; SECONDS for each target.
SECONDS = 30
fuzz:
	@scripts/fuzz $(SECONDS)

# A measured surface instead of a generated one: make demo SURFACE=file
demo:
	@scripts/deps
	@$(MAKE) --no-print-directory all
	@surface="$(SURFACE)"; case $$surface in '' | /*) ;; *) surface="$(CURDIR)/$$surface" ;; esac; \
		$(MAKE) --no-print-directory -C examples/demo SURFACE="$$surface"

# Every experiment of the thesis, and build/thesis/full/index.html or .../quick/...
.PHONY: thesis thesis-quick
thesis thesis-quick: all $(UNITS)
	+@MAKE="$(MAKE)" scripts/thesis $(if $(filter thesis,$@),full,quick)

# Those that print their options.
COMPLETED = $(BUILT) wearplot wearwatch
$(B)/install/wearpipe $(B)/install/_wearpipe $(B)/install/wearpipe.fish: $(COMPLETED:%=$(BIN)/%) scripts/completion
	@mkdir -p $(@D)
	@scripts/completion $(if $(findstring fish,$@),fish,$(if $(findstring _,$(@F)),zsh,bash)) \
		$(COMPLETED:%=$(BIN)/%) >$@

HEADERS = $(wildcard include/wearpipe/*.h)
MAN1 = $(wildcard man/*.1)
MAN5 = $(wildcard man/*.5)
MAN7 = $(wildcard man/*.7)
# What is installed, as FOLDER|FILES; make uninstall removes the same.
define installed
$(BINDIR)|$(BUILT:%=$(BIN)/%) $(SCRIPTS:%=$(BIN)/%)
$(LIBDIR)|$(LIBRARY)
$(LIBDIR)/pkgconfig|$(B)/install/wearpipe.pc
$(INCLUDEDIR)/wearpipe|$(HEADERS)
$(MANDIR)/man1|$(MAN1)
$(MANDIR)/man5|$(MAN5)
$(MANDIR)/man7|$(MAN7)
$(DATADIR)/wearpipe|share/arrivals.net
$(DATADIR)/bash-completion/completions|$(B)/install/wearpipe
$(DATADIR)/zsh/site-functions|$(B)/install/_wearpipe
$(DATADIR)/fish/vendor_completions.d|$(B)/install/wearpipe.fish
$(DATADIR)/wearpipe/python|python/wearpipe.py
$(DOCDIR)|README.md LICENSE CHANGELOG.md
endef
export installed

# The folders may differ from those of the last installation.
pc_folder = -e "s|@$(1)@|$(subst &,\&,$($(1)))|"
$(B)/install/wearpipe.pc: wearpipe.pc.in Makefile FORCE
	@mkdir -p $(@D)
	@case "$(PREFIX)" in /*) ;; *) echo "PREFIX=$(PREFIX): want an absolute path" >&2; exit 1 ;; esac
	@sed $(foreach v,PREFIX LIBDIR INCLUDEDIR VERSION,$(call pc_folder,$(v))) wearpipe.pc.in >$@
FORCE:

COMPLETIONS = $(B)/install/wearpipe $(B)/install/_wearpipe $(B)/install/wearpipe.fish
install: all $(LIBRARY) $(COMPLETIONS) $(B)/install/wearpipe.pc
	@printf '%s\n' "$$installed" | while IFS='|' read -r folder files; do \
		install -d "$(DESTDIR)$$folder" || exit; \
		for f in $$files; do \
			mode=644; [ ! -x "$$f" ] || mode=755; \
			install -m $$mode "$$f" "$(DESTDIR)$$folder" || exit; \
		done; \
	done
	@ln -sf $(SONAME) "$(DESTDIR)$(LIBDIR)/libwearpipe.so"
	@for p in $(COMPLETED); do \
		ln -sf wearpipe "$(DESTDIR)$(DATADIR)/bash-completion/completions/$$p" || exit; \
	done

uninstall:
	@printf '%s\n' "$$installed" | while IFS='|' read -r folder files; do \
		for f in $$files; do rm -f "$(DESTDIR)$$folder/$${f##*/}"; done; \
	done
	@rm -f "$(DESTDIR)$(LIBDIR)/libwearpipe.so"
	@for p in $(COMPLETED); do rm -f "$(DESTDIR)$(DATADIR)/bash-completion/completions/$$p"; done
	@for d in "$(INCLUDEDIR)/wearpipe" "$(DATADIR)/wearpipe/python" "$(DATADIR)/wearpipe" "$(DOCDIR)"; do \
		[ ! -d "$(DESTDIR)$$d" ] || rmdir "$(DESTDIR)$$d"; \
	done

dist:
	git archive --prefix=wearpipe-$(VERSION)/ -o wearpipe-$(VERSION).tar.gz HEAD

help:
	@sed -n 's/^#\t/  /p; /^PROGRAMS/q' Makefile

clean:
	rm -rf build bin

-include $(shell find $(B) -path $(B)/deb -prune -o -type f -name '*.d' -print 2>/dev/null)
