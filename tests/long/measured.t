#!/bin/sh
# roughgen: measured surfaces against parameters that other programs found for them
. "$(dirname "$0")/../tap.sh"
data=$top/../shared/data/surfaces

# value COLUMN FILE: first value of a table column
value() { column "$1" "$2" | head -1; }

if [ ! -d "$data" ]; then
	skip "measured surfaces have the parameters that other programs found" "no reference data here"
	done_testing
fi

check_measured() {
	name=$1
	size=$2
	pixel=$3
	suffix=$4
	shift 4
	roughgen --raw "$size" --pixel "$pixel" "$@" --measure "$data/$name.f64" >t
	worst=$(while read -r key want; do
		case $key in
		numpy_S[apqv] | numpy_Ssk | numpy_Sku) c=$(echo "${key#numpy_}" | tr S s) ;;
		numpy_Sdq_fwd) c=sdq ;;
		numpy_Sdq_cen) c=sdq_central ;;
		numpy_Sdq_*) c=sdq_${key#numpy_Sdq_} ;;
		*) continue ;;
		esac
		echo "$want $(value "$c" t)"
	done <"$data/$name$suffix.txt" | awk '
		{ d = $2 / $1 - 1; if (d < 0) d = -d; if (d > w) w = d; n++ }
		END { if (n == 11) print w; else print "only " n " values" }')
	# Ssk near 0 (1e-3) loses three digits of the printed twelve.
	near "$name$suffix: eleven parameters are right to the relative error" "${worst:-none}" 0 1e-9
	# Another program's shortest lag, found pixel by pixel.
	near "$name$suffix: Sal in um is right within 1 %" "$(value sal t | awk '{ print $1 * 1e6 }')" \
		"$(sed -n 's/^surfalize_um_Sal //p' "$data/$name$suffix.txt")" \
		"$(sed -n 's/^surfalize_um_Sal //p' "$data/$name$suffix.txt" | awk '{ print $1 / 100 }')"
}
set -- nanovea2 101x101 5.0000000000000004e-06 \
	ground_plu1 768x576 1.6600000858306884e-06 \
	film_wyko_opd1 640x480 1.9673303177114576e-07
while [ $# -gt 0 ]; do
	check_measured "$1" "$2" "$3" ""
	check_measured "$1" "$2" "$3" .lev --level
	shift 3
done
roughgen --raw 640x480 --pixel 1.9673303177114576e-07 --fill "$data/film_wyko_opd1.nan.f64" |
	tail -c 2457600 | od -An -v -w8 -t f8 >filled
od -An -v -w8 -t f8 "$data/film_wyko_opd1.f64" | paste filled - >both
near "116 missing samples are filled as by Gwyddion, m" "$(awk '
	{ d = $1 - $2; if (d < 0) d = -d; if (d > w) w = d } END { print (NR ? w + 0 : "no rows") }' both)" \
	0 1e-18
done_testing
