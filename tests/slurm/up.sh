#!/usr/bin/env bash
# Brings up a private Slurm on this machine: munged, slurmctld and NODES slurmd, on the loopback interface only. Needs no systemd, container, accounting
# database or control groups, neither root nor Python; everything it writes is in one folder, and tests/slurm/down.sh ends it.
#
#   packages (Debian): slurmctld slurmd slurm-client munge
#   use:               settings=$(tests/slurm/up.sh) && eval "$settings"        # exports SLURM_CONF and SLURM_TEST_DIR
#   environment:       SLURM_TEST_DIR (new, in TMPDIR, unless given), NODES (2), CPUS of each (1), SLURMD_TIMEOUT in seconds (20)
set -euo pipefail
PATH=$PATH:/usr/sbin:/sbin # the daemons, for an ordinary user
fail() { printf 'up.sh: %s\n' "$*" >&2; exit 1; }
for program in munged slurmctld slurmd sinfo; do
    command -v "$program" >/dev/null || fail "there is no $program: apt-get install slurmctld slurmd slurm-client munge"
done
host=$(hostname -s)
getent hosts "$host" >/dev/null || fail "the name of this machine, $host, does not resolve: add '127.0.0.1 $host' to /etc/hosts"
user=$(id -un)
nodes=${NODES:-2}
dir=${SLURM_TEST_DIR:-$(mktemp -d -t slurm-test.XXXXXX)}
umask 022
[ -z "$(ls -A "$dir" 2>/dev/null)" ] || fail "$dir is not empty"
mkdir -p "$dir"/{munge,ctld,log}
: >"$dir/.slurm-test" # what down.sh may remove
# munged refuses a socket in a folder that others cannot pass through.
chmod 711 "$dir" "$dir/munge"

# Ports that nobody listens at, below those that the system gives to outgoing connections.
declare -A taken
free_port() {
    while port=$((20000 + RANDOM % 12000)); do
        [ "${taken[$port]:-}" ] || (: >"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break
    done
    taken[$port]=yes
}

# A key, a socket and a pid file of its own: /etc/munge is not touched.
(umask 077 && head -c 1024 /dev/urandom >"$dir/munge/munge.key")
socket=$dir/munge/munge.socket.2

free_port
control_port=$port
lines=
names=
for i in $(seq "$nodes"); do
    free_port
    mkdir "$dir/n$i"
    lines+="NodeName=n$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$port CPUs=${CPUS:-1} RealMemory=1024 State=UNKNOWN"$'\n'
    names+="${names:+,}n$i"
done

# Traps:
# - AuthInfo cred_expire: a requeued job is not started again before its credential has expired, 120 s unless told.
# - ProctrackType linuxproc, task/none, jobacct_gather/none: everything else wants control groups, which a container may not have.
# - config_overrides: several nodes of one CPU on one machine are not what slurmd finds there.
# - ReturnToService 2: a node that was down comes back without an administrator.
# - MinJobAge: jobs that have ended stay to be asked for. MaxArraySize: as small as the tests of splitting need, and larger than their arrays.
# - PlugStackConfig: else the machine's own plugstack.conf is read.
# - SchedulerParameters: else a job that becomes ready waits up to half a minute.
cat >"$dir/slurm.conf" <<CONF
ClusterName=phicamtest
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$control_port
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$socket,cred_expire=5
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$dir/log/jobcomp.txt
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_min_interval=1,sched_interval=1,bf_interval=1
SlurmctldPidFile=$dir/ctld.pid
SlurmdPidFile=$dir/%n.pid
SlurmctldLogFile=$dir/log/slurmctld.log
SlurmdLogFile=$dir/log/%n.log
StateSaveLocation=$dir/ctld
SlurmdSpoolDir=$dir/%n
PlugStackConfig=$dir/plugstack.conf
SlurmdParameters=config_overrides
MailProg=/bin/true
SlurmdTimeout=${SLURMD_TIMEOUT:-20}
SlurmctldTimeout=20
InactiveLimit=0
KillWait=2
MinJobAge=86400
MaxArraySize=1001
${lines}PartitionName=test Nodes=$names Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
CONF
: >"$dir/plugstack.conf"
# slurmd 22.05 always loads a plugin for control groups and refuses "disabled". With the settings above cgroup/v1 touches none: it also starts where there is
# only version 2, even read-only; cgroup/v2 and autodetect fail there as root without systemd.
printf 'CgroupPlugin=cgroup/v1\n' >"$dir/cgroup.conf"

export SLURM_CONF=$dir/slurm.conf
here=$(cd "$(dirname "$0")" && pwd)
undo() {
    code=$?
    [ "$code" = 0 ] && return
    tail -n 20 "$dir"/log/*.log "$dir"/munge/*.log >&2 || true
    SLURM_TEST_DIR=$dir "$here/down.sh" >&2
}
trap undo EXIT

# What the daemons print must not end in the caller's settings.
{
    munged --key-file="$dir/munge/munge.key" --socket="$socket" --pid-file="$dir/munge/munged.pid" \
        --log-file="$dir/munge/munged.log" --seed-file="$dir/munge/munged.seed"
    slurmctld -f "$SLURM_CONF" -c
    for i in $(seq "$nodes"); do slurmd -f "$SLURM_CONF" -N "n$i"; done
} >&2
idle() { sinfo -h -N -t idle -o %N 2>/dev/null | wc -l; }
for _ in $(seq 150); do
    [ "$(idle)" = "$nodes" ] && break
    sleep 0.1
done
[ "$(idle)" = "$nodes" ] || { sinfo -N -l >&2; fail "the nodes did not come up"; }
printf 'export SLURM_CONF=%q SLURM_TEST_DIR=%q\n' "$SLURM_CONF" "$dir"
