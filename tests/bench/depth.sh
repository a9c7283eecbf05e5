#!/bin/sh
# debrisgen's volume against how the depth of a loss is found: seconds and error.
#
# scene   contact of 0.5 mm x 0.5 mm, 64 x 64 cells, Sq, correlation length and load;
#         SURFACES of each (4), seeds from SEED (1) on
# way     interpolated (the default), or cells of that part of the spacing (--depth-step),
#         the stress taken at their upper side (top, the thesis) or middle (mid)
# error   of the volume, summed over the surfaces, against cells without height: those of
#         1/64 of the spacing, top, less what 1/32 has more; worst: of a single surface;
#         particles: of their number
# seconds processor time of a surface
. "$(dirname "$0")/setup"

step=7.8125e-6

# wear WAY [OPTION ...]: volumes and particle counts in v, seconds of all in t
wear() {
	debrisgen -Y 355MPa -u 0.3 "$@" --summary s.tsv -S stats.tsv contact.nrrd >/dev/null 2>&1 ||
		[ $? -eq 3 ]
	column volume s.tsv >v.new
	column particles s.tsv >n.new
	paste v.new n.new >new
}

row() {
	paste new fine | awk -v scene="$scene" -v way="$1" -v t="$(column cpu_seconds stats.tsv)" '
		{ e = $3 ? $1 / $3 - 1 : 0; if (e * e > worst * worst) worst = e
		v += $1; w += $3; n += $2; m += $4 }
		END { printf "%s\t%s\t%.1e\t%.1e\t%.1e\t%.3g\n", scene, way, v / w - 1, worst, n / m - 1, t / NR }'
}

printf 'scene\tway\terror\tworst\tparticles\tseconds\n'
while read -r sq corr load; do
	scene=$sq,$corr,$load
	roughgen -n 64 -L 0.5mm -q "$sq" -l "$corr" -s "${SEED:-1}" -c "${SURFACES:-4}" |
		bemcontact -F "$load" -E 210GPa >contact.nrrd
	wear --depth-step "$(awk "BEGIN { print $step / 32 }")m"
	mv new coarse
	wear --depth-step "$(awk "BEGIN { print $step / 64 }")m"
	paste new coarse | awk '{ print 2 * $1 - $3, $2 }' >fine
	for parts in 1 2 4 8 16; do
		for layer in top mid; do
			wear --depth-step "$(awk "BEGIN { print $step / $parts }")m" --layer $layer
			row "1/$parts $layer"
		done
	done
	wear
	row interpolated
done <<END
0.8um 50um 1N
0.8um 50um 10N
0.8um 50um 60N
8um 50um 10N
0.2um 20um 5N
END
