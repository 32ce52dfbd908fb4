#!/usr/bin/env bash
# Measures a batch of 40 assets, ten meshes under four presets, against single bakes one after another with one thread each; what
# docs/steps/batch.md says. Usage: forty.sh FURRIER MESHES [THREADS [KILLS]]: MESHES is a folder with ten .glb or .obj files or more.
set -euo pipefail
furrier=$(realpath "$1")
meshes=$(realpath "$2")
threads=${3:-2}
kills=${4:-25}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
memory=1GB

presets=(fox mink sheep short-cat)
mkdir "$work/library"
mapfile -t inputs < <(find "$meshes" -maxdepth 1 -name '*.glb' -o -maxdepth 1 -name '*.obj' | sort | head -n 10)
{
  for preset in "${presets[@]}"; do
    mkdir "$work/library/$preset"
    cp "${inputs[@]}" "$work/library/$preset"
    printf '[[rules]]\nfiles = ["%s/*"]\npresets = ["%s"]\n' "$preset" "$preset"
  done
} >"$work/library/furrier.toml"

now() { date +%s.%N; }
since() { awk -v a="$1" -v b="$(now)" 'BEGIN { printf "%.2f", b - a }'; }
# Seconds of the clock and of processors, and the most memory, of a command.
timed() { /usr/bin/time -o "$work/time" -f '%e s, %U s of processors, %M KB' "$@"; }

start=$(now)
for preset in "${presets[@]}"; do
  mkdir -p "$work/single/$preset"
  for input in "${inputs[@]}"; do
    name=$(basename "$input")
    "$furrier" -q bake "$input" -o "$work/single/$preset/${name%.*}.glb" --preset "$preset" --threads 1 --no-cache >"$work/log" || cat "$work/log"
  done
done
echo "40 single bakes with one thread each: $(since "$start") s"

timed "$furrier" -q batch "$work/library" --threads "$threads" --memory "$memory" --no-cache >"$work/log"
echo "batch, $threads threads, --memory $memory, no cache: $(cat "$work/time")"
rm -rf "$work/library/furry" "$work/library/.furrier"
export FURRIER_CACHE="$work/cache"
timed "$furrier" -q batch "$work/library" --threads "$threads" --memory "$memory" >"$work/log"
echo "batch, $threads threads, --memory $memory, an empty cache: $(cat "$work/time")"
diff -r "$work/single" "$work/library/furry" && echo "the same bytes"

timed "$furrier" -q batch "$work/library" --threads "$threads" >"$work/log"
echo "40 up to date: $(cat "$work/time")"

sed -i 's/presets = \["sheep"\]/presets = ["sheep"]\nset = ["colour.tint=[0.3,0.2,0.2]"]/' "$work/library/furrier.toml"
timed "$furrier" -q batch "$work/library" --threads "$threads" --json >"$work/log"
echo "one preset's colour changed: $(grep '"baked"' "$work/log") $(cat "$work/time")"

# Killed at random moments, a run each; what is left behind is whole or absent, and the last run mends it.
expected="$work/expected"
cp -r "$work/library/furry" "$expected"
rm -rf "$work/library/furry" "$work/library/.furrier"
for ((i = 0; i < kills; i++)); do
  "$furrier" -q batch "$work/library" --threads "$threads" >/dev/null 2>&1 & pid=$!
  sleep "$(awk -v r=$RANDOM 'BEGIN { printf "%.2f", r / 32768 * 6 }')"
  kill -9 $pid 2>/dev/null || true
  wait $pid 2>/dev/null || true
  (cd "$work/library/furry" 2>/dev/null && find . -name '*.glb' -not -name '.*' | while read -r f; do cmp -s "$f" "$expected/$f" || echo "not whole: $f"; done) || true
done
"$furrier" batch "$work/library" --threads "$threads" >"$work/log" 2>"$work/said"
diff -r "$work/library/furry" "$expected" && echo "killed $kills times, then: the same bytes, no file too many; $(grep -c 'was stopped' "$work/said" || true) were under way at the last kill"
ls "$work/library/.furrier"
