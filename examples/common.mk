# What the experiments share: the programs on PATH, results in build/, a table and figures
#
#	TABLE = $(OUT)/numbers.tsv      the table that make shows
#	include ../common.mk
BIN = $(abspath ../../bin)
HERE = $(CURDIR)
OUT = $(abspath ../../build/$(notdir $(HERE)))
export PATH := $(BIN):$(PATH)

all: table figures
table: $(TABLE)
	@column -t -s '	' $(TABLE) 2>/dev/null || cat $(TABLE)
figures: $(OUT)/figures.done
	@echo "figures: $(OUT)/fig*.png"
clean:
	rm -rf $(OUT)

# $(call asked,WORDS): rewrites the target where other words were asked for last time, so
# that what depends on it is made anew; the target depends on FORCE
asked = mkdir -p $(OUT) && { echo "$(1)" | cmp -s - $@ || echo "$(1)" >$@; }
FORCE:

.PHONY: all table figures clean FORCE
.DELETE_ON_ERROR:
.SUFFIXES:
