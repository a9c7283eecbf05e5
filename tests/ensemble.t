#!/bin/sh
# Ensembles: any way to share the realisations out gives the bytes of a single process, and
# what was stopped, torn or refused never looks whole
. "$(dirname "$0")/tap.sh"

ensemble=$top/scripts/ensemble
surfaces='roughgen --points 16 --length 10um --sq 0.1um --corr 3um'
rest='bemcontact --pressure 50MPa --young 210GPa --boundary periodic | debrisgen --yield 355MPa --friction 0.3 2>/dev/null'
eval "$surfaces --count 6 | $rest" >whole
eval "$surfaces --count 6" >whole.nrrd
one="$surfaces --first \$K | $rest"
many="$surfaces --first \$FIRST --count \$COUNT | $rest"

"$ensemble" -j 2 6 "$one" >joined 2>err
same 'six members run on two processes' joined whole
"$ensemble" -d kept -n 2 3 "$many" >joined 2>err
same 'three members have two realisations each' joined whole
"$ensemble" -j 3 6 "$surfaces --first \$K" >joined
same 'field records are joined' joined whole.nrrd
seq 0 5 | xargs -P 3 -I K sh -c "$surfaces --first K >K.nrrd"
records --join 0.nrrd 1.nrrd 2.nrrd 3.nrrd 4.nrrd 5.nrrd >joined
same 'xargs -P gives the same bytes' joined whole.nrrd
if command -v parallel >/dev/null; then
	seq 0 5 | parallel -k "$surfaces --first {}" 2>err | records --join >joined
	same 'GNU parallel gives the same bytes' joined whole.nrrd
else
	skip 'GNU parallel gives the same bytes' 'not installed'
fi

# A folder is kept: what is whole is not made again, all else is.
member='echo $K >>made; '"$many"
"$ensemble" -d again -n 2 3 "cd $work && $member" >joined 2>err
is 'members are computed' "$(sort made | tr '\n' ' ')" '0 1 2 '
"$ensemble" -d again -n 2 3 "cd $work && $member" >joined 2>err
is 'finished members are not computed again' "$(sort made | tr '\n' ' ')" '0 1 2 '
: >again/0.done
head -c 1000 again/1.done >torn
cp torn again/1.done
"$ensemble" -d again -n 2 3 "cd $work && $member" >joined 2>err
is 'only the empty and the truncated member are computed again' "$(sort made | tr '\n' ' ')" '0 0 1 1 2 '
same 'the joined stream is right' joined whole
cp joined kept.joined
fails 'another command in the same folder' 1 'again: the folder belongs to another command' \
	"$ensemble" -d again -n 2 3 "$one"
fails 'other members of the same command' 1 'belongs to another command' \
	"$ensemble" -d again -n 1 3 "cd $work && $member"
for count in abc 0 1.5 '' 007; do
	fails "a count of '$count'" 2 "COUNT is '$count', want a whole number" "$ensemble" "$count" "$one"
done
"$ensemble" -1 true >out 2>said
is 'a negative count is refused' "$? $(grep -c '^usage: ensemble' said)" '2 1'

fails 'a member that fails is named with its command and last line' 1 \
	'member 1 (FIRST=1): exit status 1: roughgen: no-such-file.*: test $K = 0 ' \
	"$ensemble" -j 1 2 'test $K = 0 && roughgen --points 4 || roughgen no-such-file'
is 'nothing is joined' "$(wc -c <out)" 0
fails 'a failure inside of a pipeline is one' 1 'member 0' "$ensemble" -j 1 1 'roughgen no-such-file | cat'
fails 'a signal cannot be joined' 1 'signals cannot be joined' "$ensemble" -j 1 1 \
	'sensorsim --uniform 80um:80um --number 0 --duration 100ms'
fails 'a member that is cut off' 1 'member 0.*no whole stream' "$ensemble" -j 1 1 "$surfaces --count 2 | { head -c 3000; cat >/dev/null; }"

# A first member without rows loses no header.
"$ensemble" 2 "$surfaces --first \$K | bemcontact --pressure 50MPa --young 210GPa |
	debrisgen --friction 0.3 --yield \$((355 * (200 - 199 * K)))MPa 2>/dev/null" >joined 2>err
ok 'an empty first member is accepted' records --check joined
is 'an empty first member keeps the header of the table' "$(grep -c '^realisation' joined)" 1

# Two runs on one folder exclude one another; children end with their run.
"$ensemble" -j 2 -d busy 2 "echo \$\$ >>$work/pids; sleep 20; $surfaces --first \$K" >first 2>/dev/null &
run=$!
i=0
while [ $i -lt 100 ] && [ "$(cat pids 2>/dev/null | wc -l)" -lt 2 ]; do
	sleep 0.1
	i=$((i + 1))
done
fails 'a second run on the folder' 1 'busy: another run is at work' "$ensemble" -d busy 2 "echo \$\$ >>$work/pids; sleep 20; $surfaces --first \$K"
kill -TERM $run
wait $run
is 'an interrupted run is reported' $? 130
sleep 0.5
is 'the members end with the interrupted run' "$(while read -r p; do ps -o stat= -p "$p" | grep -v Z; done <pids)" ''
is 'an interrupted run joins nothing' "$(wc -c <first)" 0

# The array of a cluster, task by task
for k in 0 1 2; do
	SLURM_ARRAY_TASK_ID=$k sh "$top/scripts/slurm.sh" "$many" parts 2 2>err
done
"$ensemble" -d parts -n 2 3 "$many" >joined
same 'an array of tasks is joined' joined whole
ok 'a task with a complete member ends at once' env SLURM_ARRAY_TASK_ID=1 sh "$top/scripts/slurm.sh" "$many" parts 2
fails 'a task of another command' 1 'belongs to another command' \
	env SLURM_ARRAY_TASK_ID=1 sh "$top/scripts/slurm.sh" "$one" parts 2
done_testing
