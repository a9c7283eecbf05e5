# What the experiments share: the programs on PATH, results in build/, and three helpers
BIN = $(abspath ../../bin)
HERE = $(CURDIR)
OUT = $(abspath ../../build/$(notdir $(HERE)))
export PATH := $(BIN):$(PATH)

# $(call show,FILE): a table in columns
show = column -t -s '	' $(1) 2>/dev/null || cat $(1)
# $(call asked,WORDS): rewrites the target where other words were asked for last time, so
# that what depends on it is made anew; the target depends on FORCE
asked = mkdir -p $(OUT) && { echo "$(1)" | cmp -s - $@ || echo "$(1)" >$@; }

all:
FORCE:
clean:
	rm -rf $(OUT)
.PHONY: all clean FORCE
.DELETE_ON_ERROR:
