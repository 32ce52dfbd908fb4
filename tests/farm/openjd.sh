#!/usr/bin/env bash
# Bakes 12 assets, one of them broken, by the emitted Open Job Description template with openjd-cli, and compares with a local batch.
# Usage: openjd.sh FURRIER. Exit code 77: openjd-cli could not be installed.
set -euo pipefail
furrier=$(realpath "$1")
# shellcheck source=tests/farm/library.sh
. "$(dirname "$0")/library.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if ! { python3 -m venv "$work/venv" && "$work/venv/bin/pip" install -q 'openjd-cli==0.8.*'; } >"$work/pip.log" 2>&1; then
  tail -n 3 "$work/pip.log" >&2
  exit 77
fi
openjd="$work/venv/bin/openjd"

make_library "$work/library" 12
rm "$work/library/t7.obj" && printf 'glTF' >"$work/library/t7.glb"
cp -r "$work/library" "$work/local"
"$furrier" -q batch "$work/local" "${small[@]}" >"$work/local.log" || [ $? -eq 6 ]

"$furrier" batch plan "$work/library" "${small[@]}" --write "$work/plan.jsonl"
"$furrier" batch emit openjd "$work/plan.jsonl" -o "$work/job.json" --chunk 5
"$openjd" check "$work/job.json" --extensions TASK_CHUNKING
"$openjd" summary "$work/job.json" --extensions TASK_CHUNKING
# The scheduler's chunks end well although an asset is broken; the merge gives the verdict.
"$openjd" run "$work/job.json" --extensions TASK_CHUNKING --step Bake -p Furrier="$furrier" | tee "$work/bake.log"
grep -q 'openjd_progress: 100.0' "$work/bake.log"
if "$openjd" run "$work/job.json" --extensions TASK_CHUNKING --step Merge -p Furrier="$furrier" >"$work/merge.log"; then
  echo "the merge passed over a broken asset" >&2
  exit 1
fi
grep -q 't7.glb' "$work/merge.log"
same_outputs "$work/library/furry" "$work/local/furry"
[ "$(find "$work/library/furry" -name '*.glb' | wc -l)" -eq 11 ]
# Without the broken one, all of the job in one go.
rm "$work/library/t7.glb"
"$furrier" batch plan "$work/library" "${small[@]}" --write "$work/plan.jsonl"
rm -rf "$work/plan.jsonl.parts" "$work/library/furry"
"$furrier" batch emit openjd "$work/plan.jsonl" -o "$work/job.json" --chunk 4
"$openjd" run "$work/job.json" --extensions TASK_CHUNKING --step Merge --run-dependencies -p Furrier="$furrier" >"$work/all.log"
same_outputs "$work/library/furry" "$work/local/furry"
echo "openjd: 12 assets in chunks, the same bytes as locally; a broken one is named by the merge"
