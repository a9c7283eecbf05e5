#!/bin/sh
# Ends of streams: what was cut off is refused wherever the cut falls, in files and in
# pipes, and what was whole before it is passed on; other tools read on
. "$(dirname "$0")/tap.sh"
. "$top/tests/au.sh"

surfaces='roughgen --points 8 --length 1mm --sq 1um --corr 300um'
debris='sensorsim --uniform 80um:150um --number 5 --duration 100ms'
$surfaces --count 3 >fields
$debris --truth table >signal
$debris --single >single
for f in fields signal single table; do
	ok "a complete stream is accepted ($f)" records --check $f
	like "--check reports it as complete ($f)" "$(cat out)" "^$f: .*, whole$"
done

# refused COMMAND...: exit status 1 and one line
refused() {
	"$@" >out 2>err
	[ $? = 1 ] && [ "$(wc -l <err)" = 1 ]
}
# Cuts near both ends, and in between with a stride that is prime
for f in fields signal single table; do
	size=$(wc -c <$f)
	missed=
	n=0
	for at in $(seq 0 30) $(seq 31 97 $((size - 31))) $(seq $((size - 30)) $((size - 1))); do
		head -c "$at" $f >cut
		n=$((n + 1))
		refused records --check cut || missed="$missed $at"
	done
	is "$f: each of $n truncations is refused" "$missed" ''
done
# flip FILE AT: the file with one bit of the byte at this place flipped
flip() {
	head -c "$2" "$1"
	od -An -tu1 -j"$2" -N1 "$1" | awk '{ b = $1 % 2 ? $1 - 1 : $1 + 1; printf "\\%03o", b }' >bit
	# shellcheck disable=SC2059 # the escape is the byte
	printf "$(cat bit)"
	tail -c +$(($2 + 2)) "$1"
}
for f in fields signal table; do
	size=$(wc -c <$f)
	missed=
	for at in $(seq 60 211 $((size - 2))); do
		flip $f "$at" >bad
		refused records --check bad || missed="$missed $at"
	done
	is "$f: a flipped bit is detected at any position" "$missed" ''
done

# A record of more points than are converted and summed at a time, and no multiple of them
press='bemcontact --pressure 50MPa --estar 100GPa --boundary periodic'
roughgen --points 211x200 --length 1mm --sq 1um --corr 30um >wide
$press wide >one
for threads in 2 3; do
	$press --threads $threads wide >many
	same "$threads threads write the bytes of one" many one
done
if perl -MCompress::Zlib -e 1 2>/dev/null; then
	# shellcheck disable=SC2016 # perl's variables
	is 'the check is the crc32 of zlib over the record with zeros for its digits' "$(
		perl -MCompress::Zlib -0777 -ne 's/^(stream:=.*crc32 )([0-9a-f]{8})$/${1}00000000/m;
			printf "%s %08x", $2, crc32($_)' one | awk '{ print $1 == $2 }')" 1
else
	skip 'the check is the crc32 of zlib over the record with zeros for its digits' 'no Compress::Zlib'
fi
missed=
for at in 1500 263170 526320 600000 676000; do
	flip one $at >bad
	refused $press --threads 2 bad || missed="$missed $at"
	head -c $at one >cut
	refused $press --threads 2 cut || missed="$missed $at"
done
is 'damage in any part of such a record is found' "$missed" ''

# What is whole is passed on, without an end.
record=$(($(wc -c <fields) / 3))
head -c $((2 * record + 300)) fields >cut
fails 'a cut stream of fields is refused' 1 'record 3' bemcontact --load 1N --estar 100GPa cut
bemcontact --load 1N --estar 100GPa cut >passed 2>err
is 'two of three records are processed' "$(grep -ac '^realisation' passed)" 2
fails 'a stream whose generator failed' 1 'the stream ends after record 2, which announces another' \
	debrisgen --yield 1MPa passed
head -c $((2 * record)) fields >cut
fails 'a cut between two records is seen' 1 'the stream ends after record 2' records cut
cut=$(($(wc -c <signal) - 16 * 70 - 5))
head -c $cut signal >cut
fails 'a cut signal is refused' 1 'the signal has no end after 930 frames' bpfilter --band 0:5000 --order 2 cut
bpfilter --band 0:5000 --order 2 cut >passed 2>err
is 'all complete frames are processed' "$(frames passed 2 | wc -l)" 929 # the last stands in for the end
fails 'a signal whose generator failed' 1 'the signal has no end' duet passed
sed '$d' table >cut
fails 'a cut table is refused' 1 "the table ends after 5 rows without its '# end' line" \
	sensorsim --duration 1s cut
fails 'rows that were edited are refused' 1 'damaged or edited' sh -c "sed 's/^3/4/' table | sensorsim --duration 1s"
ok 'a table without comment lines is accepted' sh -c "sed 's/^3/4/' table | grep -v '^#' | sensorsim --duration 1s"

# A writer that was killed: the pipeline fails although the reader ran to its end.
{
	sh -c 'echo $$ >pid; exec '"$surfaces --count 1000000"
} 2>/dev/null | {
	sleep 0.3
	kill -9 "$(cat pid)"
	records --output count >out 2>err
	echo $? >status
}
is 'a generator that was killed leaves no complete stream' "$(cat status out) $(wc -l <err)" '1 1'

# Unions
cat fields fields >two
is 'cat of two streams is the union of two ensembles' "$(records --output count two)" 6
records --output nrrd two >one
ok 'records makes one stream of the output of cat' records --check one
$surfaces --count 2 >a
$surfaces --first 2 >b
cat a b | records --output nrrd >joined
same 'records --join gives the bytes of a single process' joined fields
cat a b | bemcontact --load 1N --estar 100GPa >one
bemcontact --load 1N --estar 100GPa fields >two
same 'every program reads the output of cat' one two
cat table table >two
like 'tables joined by cat are read too' "$(records --check two)" 'table: rows 10, whole'
cat signal signal >two
fails 'two signals are no signal' 1 'no end\|signals joined' records --check two
{ sed '$d' table; cat table; } >two
fails 'a cut table before a whole one' 1 "the preceding table has no '# end' line" records --check two
{ head -c $record fields; cat fields; } >two
fails 'a cut stream before a whole one' 1 'want number 2 of its stream, got number 1' records --check two

# Streams without a mark
printf 't\ty\n0\t1\n' >foreign
records --check foreign >out 2>err
is 'a foreign table cannot be checked' "$? $(cat out)" \
	'3 foreign: table: rows 1, no mark of an end: nobody can tell whether it is whole'
fails 'an empty file is no stream' 1 'empty' records --check /dev/null
{ printf '.snd\0\0\0\030\0\0\0\010\0\0\0\007\0\0\037\100\0\0\0\001'; printf '\077\340\0\0\0\0\0\0extra'; } >long.au
fails 'more samples than an AU header declares' 1 'want 8 bytes of samples, got more' records --check long.au

# Followed on purpose
{ head -c 1500 signal; sleep 0.4; tail -c +1501 signal; } >growing &
sleep 0.1
timeout 10 bpfilter --band 0:5000 --order 2 --follow growing >followed
bpfilter --band 0:5000 --order 2 signal >whole
wait
same 'a signal that is still being written is read to its end' followed whole
{ head -n 6 table; sleep 0.3; tail -n +7 table; } >growing &
sleep 0.1
ok 'a table that is still being written is read to its end' timeout 10 sensorsim --duration 100ms --follow growing
wait
head -c $cut signal >cut
ok 'a live signal may stop at any time' sh -c 'cat cut | bpfilter --band 0:5000 --order 2 --follow >live'
ok 'the end mark is written when a live signal stops' records --check live

fails 'a line longer than can be held' 1 'table: line [0-9]*: longer than 100 bytes' \
	env WEARPIPE_LIMITS=line=100 records --check table
printf 't\ty\n0\t1\n1\t2\n' >short
fails 'a first line that is too long' 1 'short: line 1: longer than 2 bytes' \
	env WEARPIPE_LIMITS=line=2 debriscount short
fails 'a first line of a recording that is too long' 1 'short: line 1: longer than 2 bytes' \
	env WEARPIPE_LIMITS=line=2 sigconvert --from text --rate 100 short
done_testing
