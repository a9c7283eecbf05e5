#!/bin/sh
# The Python module gives the numbers of the programs
. "$(dirname "$0")/tap.sh"

for python in /usr/bin/python3 python3 ''; do
	[ -n "$python" ] && "$python" -c 'import numpy' 2>/dev/null && break
done
if [ -z "$python" ] || [ -n "${ASAN_OPTIONS:-}" ]; then
	skip 'the Python module can be tested' 'no numpy, or built for the sanitizers'
	done_testing
fi
if ! make -s -C "$top" library >out 2>err; then
	fail 'make library' "$(tail -3 err)"
	done_testing
fi
WEARPIPE_LIBRARY=$top/build/install
PYTHONPATH=$top/python
PYTHONDONTWRITEBYTECODE=1
export WEARPIPE_LIBRARY PYTHONPATH PYTHONDONTWRITEBYTECODE

roughgen -n 32 -L 1mm -q 0.8um -l 100um | bemcontact --pressure 50MPa --estar 115GPa |
	debrisgen -Y 355MPa -u 0.3 --surface worn.nrrd --stress stress.nrrd --stress-layers 2 >particles.tsv
roughgen -n 32 -L 1mm -q 0.8um -l 100um | bemcontact --pressure 50MPa --estar 115GPa --fields height,pressure >c.nrrd
sensorsim --uniform 80um:120um --number 12 --duration 2s --snr 30dB --lag 0.2ms:0.5ms >s.au
duet s.au >duet.tsv
sigconvert --output text s.au >s.txt
cat >check.py <<'E2'
import numpy as np, wearpipe
dx = 1e-3 / 32
z = wearpipe.surface(32, 1e-3, sq=0.8e-6, corr=100e-6)
p, result = wearpipe.press(z, dx, 50e6, 115e9)
raw = open("c.nrrd", "rb").read()
field = np.frombuffer(raw, "<f8", 2 * 32 * 32, raw.index(b"\n\n") + 2).reshape(32, 32, 2)
print("heights", np.array_equal(z, field[:, :, 0]))
print("pressure", np.array_equal(p, field[:, :, 1]), result.converged)
print("load %.6g" % (p.sum() * dx * dx))
r = wearpipe.roughness(z, dx)
print("sq %.6g" % r.sq)
worn, particles = wearpipe.wear(z, p, dx, 355e6, friction=0.3)
print("volume %.9g %.9g" % (particles["volume"].sum(), (z - worn).sum() * dx * dx))
raw = open("stress.nrrd", "rb").read()
below = np.frombuffer(raw, "<f8", 2 * 32 * 32, raw.index(b"\n\n") + 2).reshape(2, 32, 32)
mises = wearpipe.stress(p, dx, [0, dx], friction=0.3)
t = wearpipe.stress(p, dx, dx, friction=0.3, tensor=True)[0]
by_hand = np.sqrt(0.5 * ((t[0] - t[1])**2 + (t[1] - t[2])**2 + (t[2] - t[0])**2) + 3 * (t[3]**2 + t[4]**2 + t[5]**2))
print("stress %.3g %.3g" % (np.abs(mises / below - 1).max(), np.abs(by_hand / mises[1] - 1).max()))
x = np.zeros(401); x[100] = 1
h = wearpipe.taps(200, 70, 130, 10e3)
print("filter %.3g" % np.abs(wearpipe.bandpass(x, 70, 130, 10e3)[100:301] - h).max())
record = np.array([[float(c) for c in line.split()[-2:]] for line in open("s.txt") if line[0] in "-.0123456789"])
table = [line.rstrip("\n").split("\t") for line in open("duet.tsv") if line[0] != "#"]
found = wearpipe.separate(record, 10e3)
same = [np.array_equal(found[name], [float(row[k]) for row in table[1:]], equal_nan=True)
        for k, name in enumerate(table[0]) if name not in ("particle", "verdict")]
print("separation", len(found) == len(table) - 1 > 0, all(same), list(found["verdict"]) == [row[table[0].index("verdict")] for row in table[1:]])
import warnings
for name, row in ("inside", 14), ("border", 29):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        square = np.zeros((32, 32)); square[row:row + 3, 14:17] = 2e9
        wearpipe.wear(np.zeros((32, 32)), square, dx, 355e6)
        np.stack([np.zeros((32, 32)), square], 2).tofile(name + ".raw")
        print(name, *[str(w.message) for w in said])
# a ridge in the middle of a free grid, and one on its edge
for name, row in ("middle", 15), ("edge", 0):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        ridge = np.zeros((32, 32)); ridge[row, 10:20] = 1e-6
        _, r = wearpipe.press(ridge, dx, 1e5, 115e9)
        ridge.tofile(name + ".raw")
        print("ridge", name, "%.6g" % r.edge_load, r.converged, *[str(w.message)[:29] for w in said])
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    noise = wearpipe.separate(np.random.default_rng(1).normal(size=(8192, 2)), 10e3)
    print("quiet", len(noise), [str(w.message)[:38] for w in said])
try:
    wearpipe.separate(np.zeros((4096, 2)), 10e3)
except wearpipe.Error as e:
    print("dead", e)
t = np.arange(60.0)
low, median, high = wearpipe.remaining_life(t, 0.1 * t + 0.01 * np.sin(17 * t), 10.0)
print("life", low < median < high, abs(median - 41) < 4)
for wrong in (lambda: wearpipe.press(z, dx, -1, 115e9), lambda: wearpipe.surface(0, 1e-3),
              lambda: wearpipe.remaining_life([0, 1], [0, 1], 5.0),
              lambda: wearpipe.press(z, dx, 50e6, 115e9, tolerance=2.0),
              lambda: wearpipe.press(np.ma.masked_greater(z, 1e-6), dx, 50e6, 115e9),
              lambda: wearpipe.bandpass(np.where(np.arange(3000) == 1000, np.nan, 0), 70, 130, 1e4),
              lambda: wearpipe.stress(p, dx, -1.0),
              lambda: wearpipe.roughness(np.where(z == z.max(), np.nan, z), dx)):
    try:
        wrong(); print("accepted")
    except wearpipe.Error as e:
        print("refused")
for wrong in (lambda: wearpipe.remaining_life([], [], 5.0),
              lambda: wearpipe.bandpass(np.zeros((9, 2, 2)), 70, 130, 1e4)):
    try:
        wrong(); print("accepted")
    except ValueError as e:
        print("refused")
E2
if ! "$python" check.py >got 2>err; then
	fail 'the module runs' "$(tail -5 err)"
	done_testing
fi
got() { sed -n "s/^$1 //p" got; }
is 'the heights are those of roughgen to the last bit' "$(got heights)" True
is 'the pressure is that of bemcontact and converged' "$(got pressure)" 'True True'
near 'the load is the mean pressure times the area, 50 N' "$(got load)" 50 1e-4
near 'Sq is the requested value' "$(got sq)" 8e-07 1e-12
worn=$(column volume particles.tsv | awk '{ s += $1 } END { printf "%.9g", s }')
is 'the particles are those of debrisgen and have the volume that the surface lost' "$(got volume)" "$worn $worn"
is 'the von Mises stress is that of debrisgen --stress, and that of the tensor' \
	"$(got stress | awk '{ print ($1 < 1e-9 && $2 < 1e-12) }')" 1
for name in inside border; do
	records --output nrrd --raw 32x32 --pixel 31.25um --fields "height m,pressure Pa" $name.raw |
		debrisgen -Y 355MPa >table 2>err
	echo "$name $?" >>ends
	is "the bound of the volume beyond the border is that of debrisgen, square $name" \
		"$(grep "^$name" got | grep -o '[0-9]* % more')" "$(grep -o '[0-9]* % more' err)"
done
is 'a square inside ends without a warning and one at the border with one, as in debrisgen' \
	"$(grep -c '^inside$' got) $(grep -c '^border particles are cut off' got) $(tr '\n' ' ' <ends)" '1 1 inside 0 border 3 '
for name in middle edge; do
	records --output nrrd --raw 32x32 --pixel 31.25um --fields "height m" $name.raw |
		bemcontact --pressure 100kPa --estar 115GPa --tolerance 1e-8 --table table >/dev/null 2>err
	echo "$name $? $(column edge_load table | awk '{ printf "%.6g", $1 }')" >>edges
done
is 'the load on the outermost cells is that of bemcontact' \
	"$(got ridge | cut -d' ' -f1-2 | tr '\n' ' ')" "$(cut -d' ' -f1,3 edges | tr '\n' ' ')"
is 'a ridge inside ends without a warning and one on the edge with one, as in bemcontact' \
	"$(got ridge | cut -d' ' -f3-5 | tr '\n' ' ')$(cut -d' ' -f2 edges | tr '\n' ' ')" 'True True the outermost 0 3 '
is 'the response to an impulse is the taps' "$(got filter | awk '{ print ($1 < 1e-15) }')" 1
is 'the particles in a record are those of duet to the last bit' "$(got separation)" 'True True True'
is 'a record without particles gives none and a warning' "$(got quiet)" "0 ['channels with nothing in common: no pa']"
is 'a dead sensor is named' "$(got dead)" 'channel 1 is constant: a dead sensor'
is 'the remaining life of a straight line is right' "$(got life)" 'True True'
is 'an impossible input raises an exception' "$(grep -c refused got)" 10
done_testing
