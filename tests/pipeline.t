#!/bin/sh
# Whole pipelines: any split of an ensemble and any number of threads give the same bytes,
# and the command recorded in a stream rebuilds it
. "$(dirname "$0")/tap.sh"

surfaces='roughgen -n 32 -L 1mm -q 0.8um -l 100um --crown auto'
contact='bemcontact --pressure 50MPa -E 210GPa'
debris='debrisgen -Y 355MPa -u 0.3 -E 210GPa --steps 2'

$surfaces -c 4 >whole.nrrd
for k in 0 1 2 3; do
	$surfaces -f $k -c 1
done >split.nrrd
records --join split.nrrd >joined.nrrd
same 'one process and four give the same surfaces' whole.nrrd joined.nrrd
$contact <whole.nrrd | $debris >whole.tsv
$contact -j 2 <split.nrrd | $debris -j 2 >split.tsv
same 'one thread and two give the same particles' whole.tsv split.tsv
"$top"/scripts/ensemble -j 2 4 "$surfaces -f \$K -c 1 | $contact | $debris" >ensemble.tsv
same 'four joined pipelines give the particles of one' whole.tsv ensemble.tsv

# The pipeline of each realisation stands in the table; they rebuild it together.
is 'each realisation has a line of provenance' "$(grep -c '^# cmd: ' whole.tsv)" 4
sed -n 's/^# cmd: //p' whole.tsv >commands
sh -e commands | records --join >replayed.tsv
same 'the recorded commands reproduce the table' whole.tsv replayed.tsv

# What is made of the whole ensemble says how the whole is made.
rebuilt() {
	sh -e -c "$(sed -n 's/^# cmd: //p' "$1")" >again.tsv
	same "$1 is reproduced by its own header" "$1" again.tsv
}
debrisstat whole.tsv >fits.tsv
is 'an ensemble is recorded as a count' "$(sed -n 's/^# cmd: //p' fits.tsv | grep -o -e '--first.* | b')" \
	'--first 0 --count 4 | b'
rebuilt fits.tsv
sensorsim --duration 5s --noise 5mV --truth truth.tsv whole.tsv >heard.au
duet heard.au >heard.tsv
rebuilt heard.tsv
rebuilt truth.tsv
$surfaces -f 7 -c 2 | $contact | $debris | cat whole.tsv - >gap.tsv
debrisstat -o steps gap.tsv >steps.tsv
is 'ensembles that are not consecutive form a group' \
	"$(sed -n 's/^# cmd: //p' steps.tsv | grep -o -e '--first [^|]*| b' -e '^{ ' -e '; }.*')" \
	"$(printf '%s\n' '{ ' '--first 0 --count 4 | b' '--first 7 --count 2 | b' '; } | debrisstat --output steps')"
rebuilt steps.tsv
printf '# cmd: sensorsim --first 0\nrealisation\tstep\tdiameter\tvolume\taspect\n0\t1\t1e-5\t1e-15\t1\n' >r0
is 'only realisations of surfaces are merged' \
	"$(sed 's/^0/1/; s/first 0/first 1/' r0 | cat r0 - | debrisstat | sed -n 's/^# cmd: //p')" \
	'{ sensorsim --first 0; sensorsim --first 1; } | debrisstat'

# key FILE: the recorded command of a signal
key() {
	strings -n 4 "$1" | sed -n 's/^cmd //p;/^cmd /q'
}
sensorsim --uniform 80um:150um --number 20 --duration 0.5s --noise 5mV -s 3 |
	bpfilter --order 100 --zero-phase >signal.au
sh -c "$(key signal.au)" >again.au
same 'a signal is reproduced by its own header' signal.au again.au
duet signal.au >found.tsv
is 'the table made from the signal records the signal' "$(sed -n 's/^# cmd: //p' found.tsv)" "$(key signal.au) | duet"

# Every kind of stream is replayed without a shell, from the programs of wearpipe alone.
mkdir replay && cd replay || exit
$surfaces --count 2 >surfaces
$contact surfaces >contacts
$debris --summary summary --surface worn --stress stress contacts >particles 2>err
debrisstat particles >fits 2>err
sensorsim --uniform 80um:150um --number 5 --duration 100ms --truth truth >heard
sensorsim --uniform 80um:150um --number 5 --duration 100ms --truth - >alone
bpfilter --order 50 heard >filtered
duet --separated separated --sections sections heard >found
duet --method duet --histogram histogram heard >masked 2>err
bpfilter --response --order 50 >response
bpfilter --taps --order 50 >taps
sigconvert --start 2026-11-22T03:04Z heard >begun
sigconvert --output text heard >recording
wear-volume --period 10ms found >wear 2>err
aopf --particles 20 --threshold 1e-10 wear >state 2>err
debriscount --duration 100ms found >counts 2>err
roughgen --measure surfaces >roughness
debrisgen --yield 355MPa --friction 0.3 contacts >shed 2>err
abrade --load 10mN --hardness 4GPa --friction 0.1 --slide 5um --surface surfaces --particles carried \
	--summary loads shed >grooved 2>err
layout --coils 0,25cm --snr 30dB --arrivals 100 >layouts
rwl --new --wear particles --step-time 1h --threshold-gap 11um --count 20 --rates rates >lives 2>err
delaynet --task data --columns 8 --count 3 --truth delays >lessons
records surfaces >listed
records --output table contacts >points
for f in surfaces contacts particles summary worn stress fits truth alone heard filtered found separated sections \
	histogram masked response taps begun recording wear state counts roughness grooved carried loads layouts \
	lives rates lessons delays points; do
	records --replay "$f" >"$f.again" 2>err
	same "$f: replay reproduces it" "$f" "$f.again"
done
rm truth
records --replay heard >heard.again
is 'a replay writes no file' "$(ls truth 2>/dev/null)" ''
refuse() {
	printf '# cmd: %s\nx\n1\n' "$2" >hostile
	fails "$1" 1 "$3" records --replay hostile
}
refuse 'a header with another program' 'rm -rf /nowhere' "'rm' is not a program of wearpipe"
refuse 'a header with a program by its path' '/bin/sh -c true' "'/bin/sh' is not a program"
refuse 'a header with another program behind ours' 'roughgen --points 4 | tee stolen' "'tee' is not a program"
refuse 'a header with another program beside ours' 'roughgen --points 4; touch stolen' 'touch'
refuse 'a header with a substitution' 'roughgen --points $(touch stolen)' 'a special character of the shell'
refuse 'a header with a group of commands' '{ roughgen --points 4; touch stolen; }' "'touch' is not a program"
refuse 'a header with a redirection' 'roughgen --points 4 >stolen' 'a special character of the shell'
is 'a replay executes no other program' "$(ls stolen 2>/dev/null)" ''
printf 'x\n1\n' >silent
fails 'a stream without a command' 1 'no cmd' records --replay silent
cd "$work" || exit

# Quoting: an argument that needs it comes back as it was.
$surfaces -c 1 >'it'\''s a name: here.nrrd'
roughgen --level "it's a name: here.nrrd" >measured.nrrd
(eval "$(head -c 1024 measured.nrrd | sed -n 's/^cmd:=//p')") >again.nrrd
same 'a file name with quotes, blanks and a colon is preserved' measured.nrrd again.nrrd
is 'no value contains a colon followed by a blank' \
	"$(head -c 1024 measured.nrrd | grep -a ':=' | grep -c ': ')" 0

mkdir demo && cd demo || exit
fails 'a demo with a missing surface' 1 '^roughgen: nowhere: No such file' \
	sh "$top/examples/demo/pipeline.sh" nowhere
cd "$work" || exit
done_testing
