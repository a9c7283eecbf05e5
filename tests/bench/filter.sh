#!/bin/sh
# sensorsim and bpfilter: error against run time, as a table and, where gnuplot is there,
# as build/bench/filter.png.
#
# scene     knob     what the error is; seconds are processor time of the program for
#                    2e6 samples, the median of five
# design    order    amplitude a line at 50 or 150 Hz keeps, over that of one at 100 Hz
# chosen    order    rounding: largest difference to the sum in long double, over the
#                    rms of the output; the filter chooses its transform
# block     frames   the same for order 200 by the block --latency asks for
# lines     seconds  rms of what --lines leaves of 50, 150 and 250 Hz, over what it was,
#                    among 30 particles a second and noise, by --line-window
# single    order    rounding of 32-bit output, order 200
# peer      order    the same filter and record in another program: sox, scipy (lfilter,
#                    oaconvolve), largest difference to bpfilter over the rms
# quiet, sparse, noisy, dense        sensorsim: seconds for 2e6 samples; no error
. "$(dirname "$0")/setup"

# median COMMAND...: processor seconds of five runs; the command writes "stats"
median() {
	for _ in 1 2 3 4 5; do
		"$@"
		column cpu_seconds stats
	done | sort -g | sed -n 3p
}

# difference FILE FILE: largest difference of two signals over the rms of the first
difference() {
	$py - "$1" "$2" <<-END
		import sys, numpy as np
		def au(f):
		    b = open(f, "rb").read()
		    kind = {6: ">f4", 7: ">f8"}[int.from_bytes(b[12:16], "big")]
		    return np.frombuffer(b, kind, offset=int.from_bytes(b[4:8], "big")).astype(float)
		a, b = au(sys.argv[1]), au(sys.argv[2])
		n = min(len(a), len(b))
		print("%.2e" % (abs(a[:n] - b[:n]).max() / a.std()))
	END
}

filter() {
	cat x.au | bpfilter -S stats "$@" | cat >y.au
}

simulate() {
	sensorsim -S stats "$@" | cat >/dev/null
}

row() {
	printf '%s\t%s\t%s\t%s\n' "$@"
}

all() {
	printf 'scene\tknob\terror\tseconds\n'
	sensorsim --uniform 50um:150um --number 3000 --duration 100 --noise 10mV >x.au
	for n in 100 200 400 800 1600 3200; do
		row design $n "$(bpfilter --response --order $n | awk '$1 == 50 || $1 == 150 { if ($2 > m) m = $2 }
			END { print m }')" "$(median filter --order $n)"
	done
	"$top/build/bench/filter" | awk -F '\t' '{
		printf "%s\t%s\t%s\t%.4g\n", $1, $1 == "block" ? $3 : $2 - 1, $5, 2 * $6 }'
	if py=$(command -v python3) && $py -c 'import scipy' 2>/dev/null ||
		{ py=/usr/bin/python3 && $py -c 'import scipy' 2>/dev/null; }; then
		filter
		cp y.au double.au
		row single 200 "$(filter --single; difference double.au y.au)" "$(median filter --single)"
		sensorsim --uniform 50um:150um --number 3000 --duration 100 --noise 10mV --mains 0.5,0.3,0.05 >lined.au
		for memory in 0.1 0.2 0.5 1 2 5 10; do
			# shellcheck disable=SC2317 # median calls it
			left() {
				bpfilter -b 0:5000 --zero-phase --order 2 --lines 50,150,250 --line-window $memory -S stats lined.au >y.au
			}
			seconds=$(median left)
			row lines $memory "$($py - <<-END
				import numpy as np
				au = lambda f: (lambda b: np.frombuffer(b, ">f8",
				    offset=int.from_bytes(b[4:8], "big")))(open(f, "rb").read())
				x, l, y = au("x.au"), au("lined.au"), au("y.au")
				print("%.2e" % ((y - x).std() / (l - x).std()))
			END
			)" "$seconds"
		done
		$py - <<-END
			import time, numpy as np
			from scipy.signal import firwin, lfilter, oaconvolve
			au = lambda f: (lambda b: np.frombuffer(b, ">f8", offset=int.from_bytes(
			    b[4:8], "big")).astype(float).reshape(-1, 2))(open(f, "rb").read())
			x, y = au("x.au"), au("double.au")
			h = firwin(201, [70, 130], pass_zero=False, fs=1e4)
			for f in (lambda: lfilter(h, 1, x, axis=0),
			          lambda: oaconvolve(x, h[:, None], axes=0)[:len(x)]):
			    t = []
			    for _ in range(5):
			        s = time.process_time(); z = f(); t.append(time.process_time() - s)
			    print("peer\t200\t%.2e\t%.4g" % (abs(z - y).max() / y.std(), sorted(t)[2]))
		END
		if command -v sox >/dev/null; then
			bpfilter --taps | column tap /dev/stdin >taps
			sensorsim --uniform 50um:150um --number 3000 --duration 100 --noise 10mV --calibration 2e9 >x.au # within +-1
			filter
			seconds=$($py - <<-END
				import os, subprocess
				def run():
				    before = os.times()
				    subprocess.run("sox -t au x.au -t au sox.au fir taps", shell=True)
				    after = os.times()
				    return sum(after[2:4]) - sum(before[2:4])
				print("%.4g" % sorted(run() for _ in range(5))[2])
			END
			)
			# sox takes the delay out
			filter --zero-phase
			row peer 200 "$(difference y.au sox.au)" "$seconds"
		fi
	fi
	row quiet 0 nan "$(median simulate --uniform 1um:1um --number 0 --duration 100)"
	row sparse 1 nan "$(median simulate --uniform 50um:150um --number 100 --duration 100)"
	row noisy 1 nan "$(median simulate --uniform 50um:150um --number 100 --duration 100 --noise 10mV)"
	for rate in 10 100 1000 10000; do
		row dense $rate nan "$(median simulate --uniform 50um:150um --number ${rate}00 --duration 100)"
	done
}

all | tee bench.tsv
plot filter 900,600 <<EOF
set logscale xy
set format y "%.0e"
set xlabel "seconds for 2e6 samples"
set ylabel "error"
set key outside
row(s) = sprintf("< awk '\$1 == \"%s\"' bench.tsv", s)
plot for [s in "design chosen block lines single peer"] row(s) using 4:3 with linespoints title s
EOF
