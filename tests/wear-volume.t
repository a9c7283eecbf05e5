#!/bin/sh
# wear-volume: the volume of particles over time, by hand and against awk; bad input
. "$(dirname "$0")/tap.sh"

# spheres FILE: the volumes of a table in spheres of 1 mm
spheres() {
	column y "$1" | awk '{ printf "%.6f ", $1 / 0.523598775598e-9 }'
}
{
	printf 'time1\tdiameter\tsources\tverdict\n'
	printf '%s\n' '0.5 1e-3 1 alone' '1.5 1e-3 2 overlap' '2.5 2e-3 5 unresolved' '3.5 nan 3 unresolved' \
		'4.5 1e-3 0 unresolved' '4.5 1e-3 1 alone' '5.5 1e-3 1 alone' | tr ' ' '\t'
} >crowd.tsv
wear-volume --stats stats crowd.tsv >volume.tsv 2>err
is 'a volume that lacks that of a row is marked' "$?" 3
is 'an unresolved row counts as its sources' "$(spheres volume.tsv)" "1.000000 2.000000 42.000000 42.000000 43.000000 "
is 'a row without a diameter is reported' "$(head -n 1 err)" \
	"wear-volume: crowd.tsv: rows ignored because they have no diameter: 1"
is 'the counters state what was counted' \
	"$(column particles stats) $(column particles_without_diameter stats) $(column rows_unresolved stats)" "9 1 3"
is 'the units are those of a state' "$(sed -n 's/^# units: //p' volume.tsv)" 's m3'
wear-volume --period 2s --time-scale 3600 crowd.tsv >volume.tsv 2>err
is 'period and time scale determine the times' "$(column t volume.tsv | tr '\n' ' ')$(spheres volume.tsv)" \
	"7200 14400 2.000000 42.000000 "
wear-volume --period 6s crowd.tsv >volume.tsv 2>err
is 'a period that is longer than the record has no row, as a line says' "$(spheres volume.tsv) $(sed -n '/period/p' err)" \
	" wear-volume: crowd.tsv: no period of 6 s is complete: the last particle is at 5.5 s"
ok 'the table has its end mark' records --check volume.tsv
printf '# units: ms um\ntime1\tdiameter\n500\t1000\n1500\t1000\n' >um.tsv
wear-volume um.tsv >volume.tsv
is 'times and diameters are converted from the units of the table' "$(spheres volume.tsv)" "1.000000 "

printf 'time1\tdiameter\tclass\n0.5\t1e-3\tferrous\n1.5\t1e-4\tnon-ferrous\n' | wear-volume >volume.tsv 2>err
is 'the volume of non-ferrous particles is marked' "$? $(grep -c '1 rows are non-ferrous' err)" "3 1"
# Below the skin depth d^5 = 60 d_ferrous^3 / (pi f mu0 sigma), bronze of 8e6 S/m.
printf 'time1\tdiameter\tclass\n0.5\t2e-5\tnon-ferrous\n1.5\t1e-6\tferrous\n' >bronze.tsv
wear-volume --non-ferrous bronze --excitation 200kHz bronze.tsv >volume.tsv 2>err
near 'the volume of particles of a named material is that of their own diameter' "$(column y volume.tsv | awk '{ pi = 3.14159265358979
	printf "%.6f", $1 / (pi / 6 * (60 * 2e-5 ^ 3 / (pi * 2e5 * 4e-7 * pi * 8e6)) ^ 0.6) }')" 1 1e-3
is 'the volume of particles of a named material is not marked' "$(wc -l <err | tr -d ' ')" 0
printf '2.5\t1e-5\tunclear\n' | cat bronze.tsv - >unclear.tsv
wear-volume --non-ferrous bronze --excitation 200kHz unclear.tsv >volume.tsv 2>err
is 'particles of unclear class are marked' "$? $(grep -c '1 rows are of unclear class' err)" "3 1"
ok 'particles of unclear class are not marked if all are ferrous' wear-volume --non-ferrous ferrous unclear.tsv
printf 'time1\tdiameter\tclass\tverdict\n0.5\t1e-5\tferrous\talone\n1.5\tnan\tunclear\tbubble\n' | wear-volume >volume.tsv 2>err
is 'an event that is no particle has no class' "$? $(grep -c 'unclear class' err)" "0 0"
fails 'a material where no class is known' 1 "no column 'class'" wear-volume --non-ferrous bronze um.tsv

printf 'time1\tdiameter\tamplitude\tverdict\n0.5\t1e-3\t1\talone\n1.5\t1e-4\t-0.1\talone\n' >signs.tsv
wear-volume signs.tsv >volume.tsv 2>err
is 'the volume of pulses of both signs is marked' "$? $(grep -c 'of 1 rows are positive, of 1 negative' err)" "3 1"
ok 'pulses of one sign, of either polarity, are not marked' sh -c 'grep -v -e "-0.1" signs.tsv | wear-volume'

printf 'time1\tdiameter\tverdict\n0.5\t1e-3\talone\n0.6\t1e-3\tmisfit\n1.5\t1e-3\talone\n' >doubt.tsv
wear-volume doubt.tsv >volume.tsv 2>err
is 'a doubtful row is left out' "$(spheres volume.tsv)" "1.000000 "
like 'a doubtful row is reported' "$(cat err)" '^wear-volume: 1 rows are doubtful by their verdict and left out'
wear-volume --doubtful doubt.tsv >volume.tsv 2>err
is '--doubtful counts a doubtful row' "$(spheres volume.tsv)$(cat err)" "2.000000 "

# A thousand particles that tell no verdict, against awk
awk 'BEGIN { print "t\tdiameter"; for (i = 0; i < 1000; i++) print i / 7 "\t" (1 + i % 13) * 1e-5 }' >many.tsv
wear-volume --period 10s many.tsv >volume.tsv
near 'the sum equals that of awk' "$(column y volume.tsv | tail -n 1)" \
	"$(awk '$1 < 140 { s += $2 ^ 3 } END { printf "%.15g", s * 0.52359877559829887 }' many.tsv)" 1e-22

# A live pipe gets each row as soon as it is known.
mkfifo pipe
wear-volume <pipe >live.tsv 2>err &
pid=$!
exec 8>pipe
printf 'time1\tdiameter\n0.5\t1e-3\n1.5\t1e-3\n' >&8
i=0
until [ "$(grep -c '^1' live.tsv)" = 1 ] || [ $i = 100 ]; do
	sleep 0.1
	i=$((i + 1))
done
is 'a row is written before the input ends' "$(spheres live.tsv)" "1.000000 "
exec 8>&-
wait $pid

for t in abc nan inf 1e12 -1; do
	printf 'time1\tdiameter\n0.5\t1e-4\n%s\t1e-4\n' "$t" >odd.tsv
	fails "a time of $t is refused" 1 'odd.tsv: line 3: time1' timeout 10 wear-volume odd.tsv
done
for d in -1 0 inf 0.11 abc; do
	printf 'time1\tdiameter\n0.5\t1e-4\n1\t%s\n' "$d" >odd.tsv
	fails "a diameter of $d is refused" 1 'odd.tsv: line 3: diameter' wear-volume odd.tsv
done
fails 'a period of 0 is refused' 2 'period 0: want' timeout 10 wear-volume --period 0 odd.tsv
printf 't\tdiameter\n0\t1e-4\n5\t1e-4\n' >a
cat a a >both
fails 'two tables in one are refused' 1 'both: line 5: t 0 comes after 5' wear-volume both
printf 't\tvolume\n1\t1\n' >none
fails 'a table without diameters is refused' 1 "no column 'diameter'" wear-volume none
sensorsim --number 20 --uniform 100um:200um --duration 2s --noise 1mV --truth truth >signal
records --check truth >/dev/null && head -c -40 truth >cut
wear-volume cut >out 2>err
is 'a truncated table is refused' "$? $(wc -l <err)" '1 1'
wear-volume truth >volume
records --replay volume >again 2>err
same 'the recorded pipeline reproduces the table' volume again
printf 't\tdiameter\n1\t60e-6\n# doubtful: pulses differ\n' >self.tsv
wear-volume self.tsv >out 2>err
is 'a table that calls itself doubtful is marked by status 3' "$? $(grep -c 'own account: pulses differ' err)" '3 1'
wear-volume self.tsv 2>err | tee volume | aopf --threshold 1e-10 >lives 2>err
is 'the life from a doubtful table is doubtful' "$? $(grep -c '^# doubtful: pulses differ' volume lives | tr '\n' ' ')" '3 volume:1 lives:1 '
printf 't\tdiameter\n1\tnan\n2\t60e-6\n' | wear-volume >out 2>err
is 'a volume without particles of unknown size says so' "$? $(grep '^# doubtful' out)" '3 # doubtful: rows without a diameter'
printf 't\tdiameter\tunit\n1\t60e-6\ta\n2\t60e-6\tb\n' >units.tsv
fails 'particles of two units' 1 "line 3: unit 'b' after 'a': want rows of one unit" wear-volume units.tsv
# 0.3 s is not before three periods of 0.1 s, though it is before three times the number 0.1
awk 'BEGIN { print "time1\tdiameter"; for (i = 0; i < 30; i++) printf "%.1f\t1e-4\n", i / 10 }' >border.tsv
wear-volume --period 100ms border.tsv >border.out
is 'a particle at the end of a period is in the next one' "$(column y border.out | awk '
	{ printf "%.3f\n", ($1 - last) / 5.235987756e-13; last = $1 }' | sort -u)" 1.000
is 'periods end at decimal numbers' "$(column t border.out | head -n 3 | tr '\n' ' ')" '0.1 0.2 0.3 '
done_testing
