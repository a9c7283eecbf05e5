#!/bin/sh
# What debrisgen does not see beyond the border of a free grid, and whether it says so.
#
# scene    surfaces of 96 x 96 cells of 0.8 mm x 0.8 mm: roughgen's options and the load;
#          SURFACES of each (8), seeds from SEED (1) on
# wear     options of debrisgen
# marked   steps with the warning of material cut off
# missing  volume on the grid padded with MARGIN (24) cells without load on all sides over
#          that without, less 1: mean of the marked steps, most of the others
# over     the bound of the warning over missing, least of the marked steps that miss more
#          than 0.01
. "$(dirname "$0")/setup"

pad='binmode STDIN; binmode STDOUT; local $/; my ($head, $data) = split /\n\n/, <STDIN>, 2;
	my ($n, $m) = (96, $ENV{MARGIN} // 24); my $w = $n + 2 * $m;
	$head =~ s/^sizes: 2 96 96$/sizes: 2 $w $w/m or die; $head =~ s/^stream:.*$//m; $head =~ s/\n+/\n/g;
	my $row = "\0" x (16 * $w); print "$head\n\n", $row x $m;
	print "\0" x (16 * $m), substr($data, 16 * $n * $_, 16 * $n), "\0" x (16 * $m) for 0 .. $n - 1;
	print $row x $m'

# volume FILE OPTION...: what is lost, and the bound of the warning
volume() {
	input=$1
	shift
	debrisgen "$@" --summary s.tsv "$input" >/dev/null 2>said || [ $? -eq 3 ]
	echo "$(column volume s.tsv) $(sed -n 's/.*where up to \([0-9.e+]*\) %.*/\1/p' said)"
}

printf 'scene\twear\tsteps\tmarked\tmissing\tmissing unmarked\tover\n'
while IFS=, read -r surface load; do
	for wear in '-Y 355MPa -u 0.3' '-Y 355MPa' '-Y 600MPa -u 0.15 --shear y' '-Y 200MPa -u 0.6' \
		'-Y 355MPa -u 0.3 --removal potential'; do
		seed=${SEED:-1}
		for _ in $(seq "${SURFACES:-8}"); do
			# shellcheck disable=SC2086 # words
			roughgen -n 96 -L 0.8mm $surface -s "$seed" | bemcontact $load -E 210GPa 2>/dev/null >grid.nrrd
			perl -e "$pad" <grid.nrrd >padded.nrrd
			# shellcheck disable=SC2086
			echo "$(volume padded.nrrd $wear) $(volume grid.nrrd $wear)"
			seed=$((seed + 1))
		done | awk -v scene="$surface $load" -v wear="$wear" '
			$2 > 0 { n++; e = $1 / $2 - 1 }
			$2 > 0 && NF == 3 { marked++; sum += e; o = $3 / 100 / e; if (e > 0.01 && (!over || o < over)) over = o }
			$2 > 0 && NF == 2 && e > most { most = e }
			END { printf "%s\t%s\t%d\t%d\t%s\t%.4f\t%s\n", scene, wear, n, marked,
				marked ? sprintf("%.3f", sum / marked) : "-", most, over ? sprintf("%.2f", over) : "-" }'
	done
done <<END
-q 1um -l 40um,--pressure 60MPa
-q 1um -l 150um,--pressure 30MPa
-q 2um -l 20um,--pressure 200MPa
-q 0.8um -l 50um --crown auto,-F 50N
-q 3um -l 80um --crown 6um,-F 60N
-q 1.5um -l 60um --crown 3um,-F 90N
END
