#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A campaign as a job array of a real Slurm with one node, on the loopback interface, without root: a
# worker is killed in the middle and its job requeued; the merged result is that of one process.
# usage: campaign_slurm_test.sh PROGRAM
set -euo pipefail
program=$1
for tool in sbatch scontrol squeue slurmctld slurmd; do
  PATH=$PATH:/usr/sbin command -v "$tool" >/dev/null || {
    echo "skipped: no $tool here (Debian's slurm-wlm)"
    exit 77
  }
done
PATH=$PATH:/usr/sbin
work=$(mktemp -d)
daemons=()
cleanup() {
  # After SIGTERM they would run on for some time.
  [ ${#daemons[@]} -eq 0 ] || kill -KILL "${daemons[@]}" 2>/dev/null || true
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
here=$(dirname "$0")
# shellcheck source=tests/cli/campaign/campaign_file.sh
. "$here/campaign_file.sh"

user=$(id -un) host=$(hostname -s) port=$((20000 + 2 * ($$ % 6000)))
mkdir "$work/state" "$work/spool"
cat >"$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/none
CredType=cred/none
SlurmUser=$user
SlurmdUser=$user
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
slurmctld -D >"$work/slurmctld.out" 2>&1 &
daemons+=($!)
slurmd -D >"$work/slurmd.out" 2>&1 &
daemons+=($!)
up=no
for _ in $(seq 900); do
  if sinfo -h 2>/dev/null | grep -q idle; then
    up=yes
    break
  fi
  sleep 0.2
done
if [ $up = no ]; then
  echo "skipped: Slurm's daemons do not start here:"
  tail -n 5 "$work"/*.out "$work"/*.log || true
  exit 77
fi

"$program" campaign init "$work/campaign.toml" "$work/array" --shards 8
cd "$work/array"
program_killed_once 3 "$work/quadtune"
export QUADTUNE=$work/quadtune
# Two arrays, as on a cluster that limits the indices.
job=$(sbatch --parsable --array=0-4 slurm.sh)
FIRST_SHARD=5 sbatch --array=0-2 slurm.sh

# Killed in the middle, with records of a part on disk.
for _ in $(seq 3000); do
  [ ! -f "$work/killed" ] || break
  sleep 0.1
done
[ -f "$work/killed" ] || { echo "no worker was killed" && tail -n 5 ./*.log && exit 1; }
# Slurm waits two minutes before it starts a requeued job, because its node refuses a job that starts in
# the second in which it ended ("already killed", state FAILED). Here it is started after two seconds;
# if it is refused all the same, it is requeued again.
done=no requeued=0
for _ in $(seq 600); do
  if left=$(squeue -h) && [ -z "$left" ]; then
    if [ -f 00003.flights ]; then
      done=yes
      break
    fi
    sleep 2
    scontrol requeue "${job}_3" && requeued=$((requeued + 1))
  elif [ $requeued -gt 0 ]; then
    scontrol update "JobId=${job}_3" StartTime=now 2>/dev/null || true
  fi
  sleep 0.5
done
[ $done = yes ] || {
  echo "the shard is not done after $requeued times in the queue"
  squeue
  scontrol show job "${job}_3"
  tail -n 20 "$work"/*.log
  exit 1
}
"$program" campaign status "$work/array"
grep -H . shard-3.log
grep -q 'flown, [1-9][0-9]* found' shard-3.log || { echo "nothing was found again" && exit 1; }
"$program" campaign merge "$work/array" >/dev/null

"$program" campaign run "$work/campaign.toml" "$work/alone" --shards 1 >/dev/null
[ "$(merged "$work/array")" = "$(merged "$work/alone")" ] || { echo "other bytes" && exit 1; }
echo "the array gives the bytes of one process"
