//! Slurm's array jobs.

use super::Cut;
use std::path::Path;

/// `MaxArraySize` is often 1001.
const MOST_TASKS: usize = 1000;

/// A script that submits itself: an array that bakes, and a job after it that merges. `at_once` bounds how many tasks run side by side.
pub fn slurm(plan: &Path, furrier: &Path, cut: Cut, at_once: Option<usize>, threads: usize) -> String {
    let chunk = cut.chunk.max(cut.items.div_ceil(MOST_TASKS));
    let last_task = cut.items.div_ceil(chunk).saturating_sub(1);
    let at_once = at_once.map(|n| format!("%{n}")).unwrap_or_default();
    let (plan, furrier) = (quoted(plan), quoted(furrier));
    let last_item = cut.items.saturating_sub(1);
    format!(
        r#"#!/bin/sh
# Bakes a plan on Slurm. `sh THIS` submits an array of {tasks} tasks of {chunk} assets each, and after it a job that merges; with --wait it
# waits for that and ends as it does: 0, or 6 where an asset failed.
#SBATCH --job-name=furrier
#SBATCH --cpus-per-task={threads}
#SBATCH --requeue
set -u
plan={plan}
furrier=${{FURRIER:-{furrier}}}

if [ -n "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
  first=$((SLURM_ARRAY_TASK_ID * {chunk}))
  last=$((first + {chunk} - 1))
  [ "$last" -gt {last_item} ] && last={last_item}
  # A worker that was killed, or whose machine failed for a while, is tried again here first: what it had baked stays baked.
  for try in 1 2 3; do
    "$furrier" batch run "$plan" --items "$first-$last" --threads "${{SLURM_CPUS_PER_TASK:-{threads}}}" && exit 0
    code=$?
    [ "$code" -eq 75 ] || [ "$code" -gt 128 ] || exit "$code"
  done
  # RequeueExit=75 in slurm.conf lets another machine try.
  exit 75
elif [ "${{1:-}}" = merge ]; then
  exec "$furrier" batch merge "$plan"
fi

array=$(sbatch --parsable --array=0-{last_task}{at_once} "$0") || exit 75
if [ "${{1:-}}" = --wait ]; then
  exec sbatch --wait --dependency="afterany:$array" "$0" merge
fi
exec sbatch --dependency="afterany:$array" "$0" merge
"#,
        tasks = last_task + 1,
    )
}

/// For a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.to_string_lossy().replace('\'', r"'\''"))
}
