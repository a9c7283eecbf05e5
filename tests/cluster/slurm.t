#!/bin/sh
# A Slurm array on a cluster of one node: cancelled, killed, submitted again and joined, it
# gives the bytes of a single process.  Starts munged, slurmctld and slurmd of its own.
. "$(dirname "$0")/../tap.sh"

PATH=$PATH:/usr/sbin:/sbin
for tool in munged slurmctld slurmd sbatch squeue scancel; do
	command -v $tool >/dev/null || {
		skip 'a Slurm cluster' "no $tool"
		done_testing
	}
done
[ "$(id -u)" = 0 ] || {
	skip 'a Slurm cluster' 'slurmd wants to be root'
	done_testing
}
if pidof slurmctld slurmd >/dev/null; then
	skip 'a Slurm cluster' 'one is running already'
	done_testing
fi

host=$(uname -n)
port=$((20000 + $$ % 10000))
mkdir -p slurm/state slurm/spool slurm/munge
chmod 755 "$work" slurm
chmod 700 slurm/munge
head -c 1024 /dev/urandom >slurm/munge/key
chmod 600 slurm/munge/key
socket=$work/slurm/munge/socket
cat >slurm/slurm.conf <<END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$socket
CryptoType=crypto/munge
StateSaveLocation=$work/slurm/state
SlurmdSpoolDir=$work/slurm/spool
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd.pid
SlurmctldLogFile=$work/slurm/slurmctld.log
SlurmdLogFile=$work/slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
KillWait=2
MinJobAge=300
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
SLURM_CONF=$work/slurm/slurm.conf
export SLURM_CONF

stop() {
	for f in slurmd slurmctld; do
		[ ! -e slurm/$f.pid ] || kill "$(cat slurm/$f.pid)" 2>/dev/null
	done
	[ ! -e slurm/munge/pid ] || kill "$(cat slurm/munge/pid)" 2>/dev/null
	sleep 1
	rm -rf "$work"
}
trap stop EXIT
munged --force --foreground --key-file="$work/slurm/munge/key" --socket="$socket" --pid-file="$work/slurm/munge/pid" \
	--log-file="$work/slurm/munge/log" --seed-file="$work/slurm/munge/seed" >munged.log 2>&1 &
sleep 1
slurmctld -c >slurmctld.out 2>&1
sleep 1
slurmd -c >slurmd.out 2>&1
# waits CONDITION: up to a minute
waits() {
	i=0
	until eval "$1"; do
		i=$((i + 1))
		[ $i -lt 300 ] || return 1
		sleep 0.2
	done
}
if ! waits 'sinfo -h -o %T 2>/dev/null | grep -q idle'; then
	skip 'a Slurm cluster' 'its daemons do not start here'
	tail -n 3 slurm/slurmctld.log slurm/slurmd.log munged.log slurmctld.out 2>&1 | sed 's/^/# /'
	done_testing
fi

# a crown, so that no realisation bears on its edges: that ends with status 3
surfaces='roughgen --points 64 --length 10um --sq 0.02um --corr 1um --acf gauss --crown auto'
rest='bemcontact --pressure 50MPa --young 210GPa,210GPa | debrisgen --yield 355MPa --friction 0.3 2>/dev/null'
eval "$surfaces --count 12 | $rest" >whole
# commas and blanks in the command, which waits until the tasks are cancelled
command="until [ -e $work/go ]; do sleep 0.1; done; $surfaces --first \$FIRST --count \$COUNT | $rest"
ended='[ -z "$(squeue -h)" ]'
submit() {
	sbatch --parsable --array=0-5 --output="$work/log.%a" "$top/scripts/slurm.sh" "$command" "$work/parts" 2
}
join() {
	"$top/scripts/ensemble" -j 1 -d parts -n 2 6 "$command" >joined 2>err
}

job=$(submit)
waits 'squeue -h -t running | grep -q .'
scancel "${job}_1" "${job}_5"
waits '[ -z "$(squeue -h -r -o %K | grep -x "[15]")" ]' || fail 'the cancelled tasks end' "$(squeue)"
touch go
waits "$ended" || fail 'the array ends' "$(squeue)"
is 'the tasks that were cancelled left no member' "$(ls parts/1.done parts/5.done 2>/dev/null)" ''
ls -l --time-style=full-iso parts/0.done parts/2.done >before
job=$(submit)
waits "$ended"
is 'submitted again, the array completes' "$(find parts -name '*done' | wc -l)" 6
ls -l --time-style=full-iso parts/0.done parts/2.done >after
same 'members that were whole were not made again' before after
join
same 'the joined array has the bytes of a single process' joined whole

# Killed with SIGKILL at random moments: all that runs of the jobs
command="sleep 0.3; $surfaces --first \$FIRST --count \$COUNT | $rest"
wrong=
for k in $(seq "${KILLS:-20}"); do
	rm -rf parts
	job=$(submit)
	sleep "$(awk -v s="$k" 'BEGIN { srand(s); print 2.5 * rand() }')"
	scancel --signal=KILL --full "$job"
	scancel "$job"
	waits "$ended"
	for part in parts/*.done; do
		[ ! -e "$part" ] || records --check "$part" >/dev/null 2>&1 || wrong="$wrong $k:$part"
	done
	submit >job
	waits "$ended"
	join || wrong="$wrong $k:$(tail -n 1 err)"
	cmp -s joined whole || wrong="$wrong $k:differs"
done
is "killed at ${KILLS:-20} moments and submitted again" "$wrong" ''
done_testing
