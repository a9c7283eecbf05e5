#!/bin/sh
# The matrix of instruments with all seeds.
BIN=${BIN:-${0%/*}/../../bin}
PATH=$BIN:$PATH
export PATH
command -v perl >/dev/null || { echo "1..0 # SKIP no perl"; exit 0; }
[ -x "${0%/*}/../../build/matrix/simulate" ] || { echo "1..0 # SKIP run by make check-long"; exit 0; }
exec "${0%/*}/../matrix/run" -t -l
