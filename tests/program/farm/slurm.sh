#!/bin/bash
# Runs a job in a Slurm cluster of this one machine that lives only for the time of this script.
#
#   slurm.sh [SBATCH-OPTION...] JOB.sh [ARG...]   submits with `sbatch --wait`
#   slurm.sh -c COMMAND [ARG...]                  runs COMMAND while the cluster is up
#                                                 (sbatch, squeue, ... find it by $SLURM_CONF)
#
# Exit status: that of `sbatch --wait` (the highest one of the array tasks) or of COMMAND;
# 77 where slurm-wlm is not installed; 99 where the cluster does not come up; 124 after the time limit.
# SLURM_SH_TIMEOUT: seconds for the job or command (default 300).
# SLURM_SH_CPUS: the CPUs of the node (default: nproc).   SLURM_SH_CONF: more lines for slurm.conf.
#
# Needs neither systemd nor cgroups nor the system's munge key; everything is in one temporary
# directory and on free ports of 127.0.0.1. Meant for root in a container.
set -u
PATH=$PATH:/usr/sbin:/sbin

for p in munged slurmctld slurmd sbatch squeue scancel sinfo scontrol; do
  if ! command -v "$p" >/dev/null 2>&1; then
    echo "slurm-wlm is not installed"
    exit 77
  fi
done
if [ $# -eq 0 ]; then
  sed -n '2,6s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi

limit=${SLURM_SH_TIMEOUT:-300}
cpus=${SLURM_SH_CPUS:-$(nproc)}
T=$(mktemp -d /tmp/slurm.XXXXXX) || exit 99
# munged wants its socket's directory open to all and its key's closed
chmod 755 "$T" && mkdir "$T/ctld" "$T/slurmd" "$T/munge" "$T/sock" && chmod 700 "$T/munge" || exit 99
pids=()

# the processes that were started with this cluster's SLURM_CONF: slurmstepd and the jobs' own
strays() {
  local f e
  for f in /proc/[0-9]*/environ; do
    while IFS= read -r -d '' e; do
      if [ "$e" = "SLURM_CONF=$T/slurm.conf" ]; then
        f=${f#/proc/}; f=${f%/environ}
        case " $$ $BASHPID ${pids[*]-} " in *" $f "*) ;; *) echo "$f" ;; esac
        break
      fi
    done <"$f"
  done 2>/dev/null
}

stop() { # $1: pid of a child; TERM, after 5 s KILL
  local i
  kill -TERM "$1" 2>/dev/null || return 0
  for ((i = 0; i < 50; i++)); do
    kill -0 "$1" 2>/dev/null || break
    sleep 0.1
  done
  kill -KILL "$1" 2>/dev/null
  wait "$1" 2>/dev/null
}

cleanup() {
  local i p
  trap '' INT TERM HUP
  if [ -n "${up-}" ]; then
    [ -z "${child-}" ] || stop "$child"
    timeout 5 scancel --quiet --full --user="$(id -un)" 2>/dev/null
    for ((i = 0; i < 50; i++)); do
      [ -n "$(timeout 5 squeue -h 2>/dev/null)" ] || break
      sleep 0.1
    done
  fi
  # slurmctld, slurmd, munged: the last started is stopped first, munged last
  for ((i = ${#pids[@]} - 1; i >= 0; i--)); do stop "${pids[i]}"; done
  for p in $(strays); do kill -KILL "$p" 2>/dev/null; done
  if [ -n "${SLURM_SH_KEEP-}" ]; then echo "slurm.sh: kept $T" >&2; else rm -rf -- "$T"; fi
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
trap 'exit 129' HUP

fail() {
  local f
  echo "slurm.sh: $*" >&2
  for f in munged slurmctld slurmd; do
    [ -s "$T/$f.log" ] && { echo "--- $f.log"; tail -n 20 "$T/$f.log"; } >&2
  done
  exit 99
}

alive() { kill -0 "$1" 2>/dev/null; }

within() { # seconds, command...: true as soon as the command is; false after the seconds
  local end=$((SECONDS + $1)); shift
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.1
  done
}

# two free ports below the range that the kernel gives to outgoing connections
port() {
  local i p
  for ((i = 0; i < 100; i++)); do
    p=$((10000 + RANDOM % 22000))
    [ "$p" = "${1-}" ] && continue
    (exec 3<>"/dev/tcp/127.0.0.1/$p") 2>/dev/null || { echo "$p"; return; }
  done
  return 1
}
p1=$(port) && p2=$(port "$p1") || fail "no free port"

me=$(id -un)
host=$(hostname -s 2>/dev/null || hostname)
cat >"$T/slurm.conf" <<END
ClusterName=c
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$p1
SlurmdPort=$p2
SlurmUser=$me
SlurmdUser=$me
AuthType=auth/munge
AuthInfo=socket=$T/sock/munge
CredType=cred/munge
StateSaveLocation=$T/ctld
SlurmdSpoolDir=$T/slurmd
SlurmctldPidFile=$T/ctld/pid
SlurmdPidFile=$T/slurmd/pid
SlurmctldLogFile=$T/slurmctld.log
SlurmdLogFile=$T/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SwitchType=switch/none
MpiDefault=none
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=1000000 State=UNKNOWN
PartitionName=p Nodes=ALL Default=YES MaxTime=INFINITE State=UP
${SLURM_SH_CONF-}
END
# newer versions look for a cgroup plugin whatever ProctrackType says
case $(slurmctld -V) in
  *" 2"[0-2].* | *" 23.02"*) : >"$T/cgroup.conf" ;;
  *) echo "CgroupPlugin=disabled" >"$T/cgroup.conf" ;;
esac

(umask 077 && head -c 128 /dev/urandom >"$T/munge/key") || fail "no munge key"
munged --foreground --key-file="$T/munge/key" --socket="$T/sock/munge" --pid-file="$T/munge/pid" \
  --seed-file="$T/munge/seed" --log-file="$T/munge/log" --num-threads=2 </dev/null >"$T/munged.log" 2>&1 &
pids+=($!)
within 10 test -S "$T/sock/munge" && alive "${pids[0]}" || fail "munged does not start"

export SLURM_CONF=$T/slurm.conf
unset "${!SLURM_JOB@}" "${!SLURM_ARRAY@}" "${!SBATCH_@}" # of a job this script may itself run in
slurmctld -D -i </dev/null >"$T/slurmctld.out" 2>&1 &
pids+=($!)
within 20 scontrol ping && alive "${pids[1]}" || fail "slurmctld does not start: $(tail -n 3 "$T/slurmctld.out")"
up=1
slurmd -D </dev/null >"$T/slurmd.out" 2>&1 &
pids+=($!)
idle() { alive "${pids[2]}" && [ "$(sinfo -h -o %T)" = idle ]; }
within 30 idle || fail "slurmd does not start: $(tail -n 3 "$T/slurmd.out")"
echo "slurm.sh: $(slurmctld -V) is up, $cpus CPUs" >&2

# in the background, so that a signal to this script is not kept waiting
if [ "$1" = -c ]; then
  shift
  timeout --kill-after=10 "$limit" "$@" &
else
  timeout --kill-after=10 "$limit" sbatch --wait "$@" &
fi
child=$!
wait "$child"
status=$?
child=
[ "$status" -ne 124 ] || echo "slurm.sh: stopped after $limit s" >&2
# how each task ended (slurmctld forgets jobs only after 5 minutes)
scontrol -o show job 2>/dev/null |
  sed 's/^JobId=[^ ]* ArrayJobId=\([^ ]*\) ArrayTaskId=\([^ ]*\) /JobId=\1_\2 /' |
  sed -nE 's/^JobId=(\S*).* JobName=(\S*) .* JobState=(\S*) .* ExitCode=(\S*) RunTime=(\S*) .*/\1 \2 \3 \4 \5/p' |
  sed 's/^/slurm.sh: job /' >&2
exit "$status"
