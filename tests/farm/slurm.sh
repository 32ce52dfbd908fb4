#!/usr/bin/env bash
# Bakes 12 assets by the emitted Slurm script on a slurmctld and slurmd of this machine's own, kills a worker midway, and compares with a
# local batch. Usage: slurm.sh FURRIER, as root on Debian, which installs slurm-wlm where it is missing. Exit code 77: no Slurm to be had.
set -euo pipefail
furrier=$(realpath "$1")
# shellcheck source=tests/farm/library.sh
. "$(dirname "$0")/library.sh"
[ "$(id -u)" = 0 ] || { echo "Slurm's daemons are started as root here" >&2; exit 77; }
if ! command -v slurmctld >/dev/null && ! command -v slurmctld-wlm >/dev/null; then
  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm || exit 77
fi
daemon() { command -v "$1" || command -v "$1-wlm"; }

work=$(mktemp -d)
export SLURM_CONF="$work/slurm.conf"
pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT
mkdir -p "$work/state" "$work/spool"
# No munge, no cgroups, ports of the loopback.
cat >"$SLURM_CONF" <<CONF
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/ctld.pid
SlurmdPidFile=$work/d.pid
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
RequeueExit=75
MpiDefault=none
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
"$(daemon slurmctld)" -D >"$work/ctld.log" 2>&1 & pids+=($!)
"$(daemon slurmd)" -D -N "$(hostname -s)" >"$work/d.log" 2>&1 & pids+=($!)
for ((i = 0; i < 60; i++)); do sinfo -h -t idle 2>/dev/null | grep -q . && break; sleep 1; done
sinfo -h -t idle | grep -q . || { cat "$work/ctld.log" "$work/d.log" >&2; exit 1; }

make_library "$work/library" 12
cp -r "$work/library" "$work/local"
"$furrier" -q batch "$work/local" "${small[@]}" >"$work/local.log"
"$furrier" batch plan "$work/library" "${small[@]}" --write "$work/plan.jsonl"
"$furrier" batch emit slurm "$work/plan.jsonl" -o "$work/job.sh" --chunk 3 --at-once 2

# The first worker that is asked for items 3-5 kills itself while it bakes.
cat >"$work/worker" <<WORKER
#!/bin/sh
case "\$*" in *"--items 3-5"*)
  if mkdir "$work/killed" 2>/dev/null; then
    "$furrier" "\$@" & pid=\$!
    while [ -z "\$(ls "$work"/library/furry/.furrier/journal-\$pid-* 2>/dev/null)" ] && kill -0 \$pid 2>/dev/null; do :; done
    kill -9 \$pid
    kill -9 \$\$
  fi;;
esac
exec "$furrier" "\$@"
WORKER
chmod +x "$work/worker"
cd "$work"
start=$SECONDS
FURRIER="$work/worker" sh "$work/job.sh" --wait
echo "slurm: 12 assets in 4 tasks, two at once: $((SECONDS - start)) s"
[ -d "$work/killed" ] || { echo "no worker was killed" >&2; exit 1; }
"$furrier" batch merge "$work/plan.jsonl"
same_outputs "$work/library/furry" "$work/local/furry"

# A broken asset: the tasks end well, the merge does not.
printf 'glTF' >"$work/library/broken.glb"
"$furrier" batch plan "$work/library" "${small[@]}" --write "$work/plan2.jsonl"
"$furrier" batch emit slurm "$work/plan2.jsonl" -o "$work/job2.sh" --chunk 5
code=0
FURRIER="$furrier" sh "$work/job2.sh" --wait || code=$?
[ "$code" -eq 6 ] || { echo "the merge job ended with $code, 6 expected" >&2; exit 1; }
echo "slurm: the same bytes as locally, one worker killed midway; a broken asset is named by the merge"
