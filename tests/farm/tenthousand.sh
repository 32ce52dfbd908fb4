#!/usr/bin/env bash
# Measures a plan of 10,000 assets of one triangle, and runs that find 1,000 and 10,000 of them up to date; what docs/steps/batch.md says.
# Usage: tenthousand.sh FURRIER [COUNT]
set -euo pipefail
furrier=$(realpath "$1")
count=${2:-10000}
# shellcheck source=tests/farm/library.sh
. "$(dirname "$0")/library.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
timed() { /usr/bin/time -o "$work/time" -f '%e s, %U s of processors, %M KB' "$@"; }
# Next to nothing to bake, so that what is measured is all the rest.
empty=(--layers 2 --texture-size 16 --set fins.texture_width=16 --set fins.texture_height=16
  --set guard.density_per_cm2=0 --set undercoat.density_per_cm2=0)

make_library "$work/library" "$count"
make_library "$work/tenth" $((count / 10))
timed "$furrier" batch plan "$work/library" --write "$work/plan.jsonl"
echo "plan of $count: $(cat "$work/time"), $(stat -c %s "$work/plan.jsonl") bytes"
for library in tenth library; do
  timed "$furrier" -q batch "$work/$library" "${empty[@]}" >"$work/log"
  echo "$library baked: $(cat "$work/time")"
  timed "$furrier" -q batch "$work/$library" "${empty[@]}" >"$work/log"
  echo "$library up to date: $(cat "$work/time")"
done
