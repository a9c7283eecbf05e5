# What the experiments share: the programs on PATH, results in build/, a table and figures
#
#	include ../common.mk
#
# SIZE is quick or full.  An experiment makes $(OUT)/values.tsv, rows of key, kind and value
# as ../results wants them, and $(OUT)/figures.done when its figures are drawn.  The results
# stand beside the numbers of the thesis in a table that all experiments have in common.
ifneq ($(word 2,$(CURDIR)),)
$(error the experiments do not run in a path with a blank: $(CURDIR))
endif
BIN = $(abspath ../../bin)
HERE = $(CURDIR)
SIZE = quick
OUT = $(abspath ../../build/$(notdir $(HERE)))
export PATH := $(BIN):$(PATH)

all: table figures
results: $(OUT)/results.tsv
table: $(OUT)/results.tsv
	@../compare ../thesis.tsv $(notdir $(HERE)) $< | { column -t -s '	' 2>/dev/null || cat; }
figures: $(OUT)/figures.done
	@echo "figures: $(OUT)/fig*.png"
clean:
	rm -rf $(OUT)

$(OUT)/results.tsv: $(OUT)/values.tsv ../results
	../results $< >$@.part
	@mv $@.part $@

# $(call by_size,QUICK,FULL)
by_size = $(if $(filter full,$(SIZE)),$(2),$(1))
# $(call asked,WORDS): rewrites the target where other words were asked for last time, so
# that what depends on it is made anew; the target depends on FORCE
asked = mkdir -p $(OUT) && { echo "$(1)" | cmp -s - $@ || echo "$(1)" >$@; }
FORCE:

.PHONY: all results table figures clean FORCE
.DELETE_ON_ERROR:
.SUFFIXES:
